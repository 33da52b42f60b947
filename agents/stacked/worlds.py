"""The worlds of all agents, one each, stepped one after the other on the host; for every domain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor

from agents.features import adapt
from agents.stage import Stage
from agents.task import BoolArray, Domain, FloatArray, Layout


@dataclass(frozen=True)
class LaneStep:
    """What one step told about every lane of every agent; tensors on the learner's device."""

    observation: Tensor
    """True next observations `[S, L, d]` in the widest layout; a finished lane is not reset."""
    reward: Tensor
    """`[S, L]`"""
    terminated: Tensor
    """`[S, L]`, bool."""
    over: Tensor
    """Terminated or truncated `[S, L]`, bool."""
    outcome: Tensor
    """How each episode stands or ended `[S, L]`, codes of the domain."""


class Worlds(Protocol):
    """Where all agents gather experience."""

    worlds: list[Any]
    """The `TaskWorld` of each agent; empty places hold None."""

    def open(self, agent: int, stage: Stage) -> Tensor:
        """A fresh world for an agent's stage; its first observations `[L, d]`."""
        ...

    def step(self, action: Tensor, /) -> LaneStep:
        """Advance every lane by one step with actions `[S, L, 1]` [rad]."""
        ...

    def restart(self, over: BoolArray, /) -> Tensor:
        """Start these lanes `[S, L]` anew; the observations of all lanes `[S, L, d]`."""
        ...

    def take(self, agents: Sequence[int], /) -> Worlds:
        """The worlds of these agents alone, in this order."""
        ...


class HostWorlds:
    """Worlds of any domain, seen through NumPy arrays."""

    def __init__(self, domain: Domain, layout: Layout, agents: int, lanes: int, device: torch.device) -> None:
        """Places for `agents`; observations are shown in `layout`, which has the subtasks of every task."""
        self.domain, self.layout, self.lanes, self.device = domain, layout, lanes, device
        self.worlds: list[Any] = [None] * agents
        self._layouts: list[Any] = [layout] * agents
        self._seen = np.zeros((agents, lanes, layout.size), np.float32)

    def open(self, agent: int, stage: Stage) -> Tensor:
        """See `Worlds.open`."""
        self.worlds[agent] = self.domain.world(stage.task, self.lanes, stage.seed)
        self._layouts[agent] = stage.task.layout
        self._see(agent, self.worlds[agent].reset())
        return self._tensor(self._seen[agent])

    def step(self, action: Tensor) -> LaneStep:
        """See `Worlds.step`."""
        told: dict[str, list[Any]] = {"reward": [], "terminated": [], "over": [], "outcome": []}
        for agent, (world, turns) in enumerate(zip(self.worlds, action.cpu().numpy(), strict=True)):
            step = world.step(turns)
            self._see(agent, step.observation)
            told["reward"].append(step.reward)
            told["terminated"].append(step.terminated)
            told["over"].append(step.terminated | step.truncated)
            told["outcome"].append(world.outcome)
        return LaneStep(
            self._tensor(self._seen), **{name: self._tensor(np.stack(parts)) for name, parts in told.items()}
        )

    def restart(self, over: BoolArray) -> Tensor:
        """See `Worlds.restart`."""
        for agent in np.flatnonzero(over.any(axis=1)):
            self._see(int(agent), self.worlds[agent].reset(lanes=np.flatnonzero(over[agent])))
        return self._tensor(self._seen)

    def take(self, agents: Sequence[int]) -> HostWorlds:
        """See `Worlds.take`."""
        other = HostWorlds(self.domain, self.layout, len(agents), self.lanes, self.device)
        other.worlds = [self.worlds[agent] for agent in agents]
        other._layouts = [self._layouts[agent] for agent in agents]
        other._seen = self._seen[list(agents)].copy()
        return other

    def _see(self, agent: int, observation: FloatArray) -> None:
        own, full = self._layouts[agent], self.layout
        same = own.names == full.names
        self._seen[agent] = observation if same else adapt(observation, own, full, self.domain.default_block)

    def _tensor(self, values: Any) -> Tensor:
        # A copy even on the CPU: the arrays are written again at the next step.
        return torch.tensor(values, device=self.device)
