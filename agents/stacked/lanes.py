"""What the lanes of all agents carry from one step to the next."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass
class Lanes:
    """Tensors on the device, agents first, then lanes."""

    observation: Tensor
    """Current observations in the widest layout `[S, L, d]`, physical units."""
    features: Tensor
    """The same, encoded `[S, L, f]`."""
    reused: Tensor
    """Lanes whose last draw of ε fell on reuse `[S, L]`."""
    noise: Tensor
    """Exploration noise of the step before `[S, L, 1]` [action units]."""
    restarted: Tensor
    """Lanes whose episode has just begun `[S, L]`."""
    episode_return: Tensor
    """Return of the running episodes `[S, L]`."""
    episode_steps: Tensor
    """Steps of the running episodes `[S, L]`."""
    seeds: Tensor
    """Seed of every agent's stage, int64 `[S]`."""
    steps: Tensor
    """Steps of all lanes in every agent's stage, int64 `[S]`: they count the draws."""
    updates: Tensor
    """Gradient steps of every agent's stage, int64 `[S]`, likewise."""
    alpha: Tensor
    """Weight of policy distillation of every agent `[S]`."""
    epsilon: Tensor
    """Probability of policy reuse of every agent `[S]`."""
    fresh: Tensor
    """1 for the flags of the subtasks that every agent's guide does not know `[S, f]`, Eq. (13)."""
    allowed: Tensor
    """Lane-steps of the epoch in which transfer was allowed, by agent `[S]`."""
    guided: Tensor
    """Lane-steps of the epoch that the guide flew, by agent `[S]`."""

    @classmethod
    def empty(cls, agents: int, lanes: int, columns: int, features: int, device: torch.device) -> Lanes:
        """Lanes of agents that have not begun."""

        def zeros(*shape: int, kind: torch.dtype = torch.float32) -> Tensor:
            return torch.zeros(shape, dtype=kind, device=device)

        return cls(
            observation=zeros(agents, lanes, columns),
            features=zeros(agents, lanes, features),
            reused=zeros(agents, lanes, kind=torch.bool),
            noise=zeros(agents, lanes, 1),
            restarted=zeros(agents, lanes, kind=torch.bool),
            episode_return=zeros(agents, lanes),
            episode_steps=zeros(agents, lanes),
            seeds=zeros(agents, kind=torch.int64),
            steps=zeros(agents, kind=torch.int64),
            updates=zeros(agents, kind=torch.int64),
            alpha=zeros(agents),
            epsilon=zeros(agents),
            fresh=zeros(agents, features),
            allowed=zeros(agents, kind=torch.int64),
            guided=zeros(agents, kind=torch.int64),
        )

    def clear(self, agent: int) -> None:
        """Zero everything of one agent, in place."""
        for item in dataclasses.fields(self):
            getattr(self, item.name)[agent] = 0

    def take(self, agents: Sequence[int]) -> Lanes:
        """The lanes of these agents alone, in this order; copies."""
        chosen = list(agents)
        return Lanes(**{item.name: getattr(self, item.name)[chosen].clone() for item in dataclasses.fields(self)})
