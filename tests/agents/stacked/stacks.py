"""Stacks of small agents beside the same agents by themselves, and batches for both."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import torch

from agents.config import PROFILES, Hyperparameters
from agents.replay import Batch
from agents.stacked.learner import StackedTd3
from agents.stacked.residence import move_in
from agents.td3 import Td3

ROWS, FEATURES, LIMIT = 48, 7, 1.5


def hyper_for(layer_norm: bool = True, two_returns: bool = True, **changes: object) -> Hyperparameters:
    given = {"hidden": (24, 16), "layer_norm": layer_norm, "two_returns": two_returns, "reward_scale": 0.5}
    return dataclasses.replace(PROFILES["fast"], **{**given, **changes})


class Alone(Td3):
    """The autograd learner in a chosen precision, with the noise of the target policy given from outside."""

    def __init__(self, hyper: Hyperparameters, seed: int, dtype: torch.dtype = torch.float32) -> None:
        super().__init__(FEATURES, hyper, LIMIT, seed)
        self.noise = torch.zeros(ROWS, 1, dtype=dtype)
        self._sums = self._sums.to(dtype)
        for name in ("actor", "critics", "target_actor", "target_critics", "average_actor"):
            getattr(self, name).to(dtype)
        rate = hyper.learning_rate
        self.actor_optimizer = torch.optim.Adam(self.actor.parameters(), rate, fused=True)
        self.critic_optimizer = torch.optim.Adam(self.critics.parameters(), rate, fused=True)

    def weights(self, alpha: float) -> torch.Tensor:
        return torch.tensor([1.0, alpha] if self.hyper.two_returns else [1.0], dtype=self.noise.dtype)

    @torch.no_grad()
    def targets(self, batch: Batch, alpha: float, weights: torch.Tensor) -> torch.Tensor:
        drawn, given = torch.randn, self.noise
        try:
            torch.randn = lambda *_args, **_named: given.clone()  # type: ignore[assignment]
            return super().targets(batch, alpha, weights)
        finally:
            torch.randn = drawn


def stack_of(alone: Sequence[Td3], hyper: Hyperparameters, dtype: torch.dtype = torch.float32) -> StackedTd3:
    """All these learners, stacked as they are at their beginning."""
    stack = StackedTd3(len(alone), FEATURES, hyper, LIMIT, dtype=dtype)
    for place, one in enumerate(alone):
        move_in(stack, place, one, np.arange(FEATURES))
    return stack


def batches(seed: int, count: int, dtype: torch.dtype = torch.float32) -> list[tuple[Batch, torch.Tensor]]:
    """Random batches of one agent, each with noise for the target policy."""
    g = torch.Generator().manual_seed(seed)

    def draw(*shape: int) -> torch.Tensor:
        return torch.randn(shape, generator=g).to(dtype)

    found = []
    for _ in range(count):
        ends = (torch.rand(ROWS, generator=g) < 0.1).to(dtype)
        action, discount = draw(ROWS, 1).clamp(-1, 1), 0.99 * (1.0 - ends)
        batch = Batch(draw(ROWS, FEATURES), action, draw(ROWS), -draw(ROWS).abs(), discount, draw(ROWS, FEATURES))
        found.append((batch, draw(ROWS, 1)))
    return found


def together(each: Sequence[tuple[Batch, torch.Tensor]]) -> tuple[Batch, torch.Tensor]:
    """The batches and the noise of several agents, stacked."""
    parts = zip(*(batch for batch, _ in each), strict=True)
    return Batch(*(torch.stack(part) for part in parts)), torch.stack([noise for _, noise in each])


def networks(stack: StackedTd3, place: int) -> dict[str, torch.Tensor]:
    """Every tensor of one agent, flat."""
    critics, targets = stack.critics.values[place], stack.target_critics[place]
    return {
        "actor": stack.actor.values[place, 0],
        "first": critics[0],
        "second": critics[1],
        "target_actor": stack.target_actor[place, 0],
        "target_first": targets[0],
        "target_second": targets[1],
        "average": stack.average_actor[place, 0],
    }


def flat_networks(one: Td3) -> dict[str, torch.Tensor]:
    """The same of a learner by itself, in the order in which a stack keeps them."""
    named = {
        "actor": one.actor,
        "first": one.critics.first,
        "second": one.critics.second,
        "target_actor": one.target_actor,
        "target_first": one.target_critics.first,
        "target_second": one.target_critics.second,
        "average": one.average_actor,
    }
    return {name: flat(module) for name, module in named.items()}


def flat(module: torch.nn.Module, slopes: bool = False) -> torch.Tensor:
    """Parameters (or gradients) of an actor or a critic: layer by layer weight `[in, out]`, bias, scale, shift."""
    linear = [one for one in module.modules() if isinstance(one, torch.nn.Linear)]
    norms = [one for one in module.modules() if isinstance(one, torch.nn.LayerNorm)]
    parts: list[torch.Tensor] = []
    for index, layer in enumerate(linear):
        parts += [_of(layer.weight, slopes).t(), _of(layer.bias, slopes)]
        if index < len(norms):
            parts += [_of(norms[index].weight, slopes), _of(norms[index].bias, slopes)]
    return torch.cat([part.flatten() for part in parts])


def _of(parameter: torch.Tensor, slopes: bool) -> torch.Tensor:
    if not slopes:
        return parameter.detach()
    assert parameter.grad is not None
    return parameter.grad
