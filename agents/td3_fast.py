"""The same TD3 with gradients written by hand: less work per update, equal to `td3.Td3` up to rounding.

All parameters of a network group are views of one flat tensor, all gradients views of another (`flat_networks`). Both
critics go through one product per layer (`passes`), which writes gradients straight into their views; Adam and the
target average run on one tensor each, and the actor's step computes nothing of the critic but the slope towards the
action. Autograd is the test oracle.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from numpy.typing import NDArray
from torch import Tensor

from agents.arrays import Arrays
from agents.flat_networks import FlatNetworks, adam_step
from agents.hyperparameters import Hyperparameters
from agents.layers import shapes_of
from agents.passes import action_slope, actions, backward, forward
from agents.replay import Batch
from agents.td3 import Td3
from agents.torch_state import array_of, tensor_of

MOMENTS = ("exp_avg", "exp_avg_sq")


class FastTd3(Td3):
    """Drop-in replacement of `Td3`: the same networks, draws and numbers, other arithmetic order only."""

    def __init__(self, features: int, hyper: Hyperparameters, action_limit: float, seed: int) -> None:
        """Initialise as `Td3` does, then move all parameters into flat tensors."""
        super().__init__(features, hyper, action_limit, seed)
        actor, critic = shapes_of(features, hyper)
        self.flat_actor = FlatNetworks([self.actor], actor)
        self.flat_critics = FlatNetworks([self.critics.first, self.critics.second], critic)
        self._target_actor = FlatNetworks([self.target_actor], actor)
        self._target_critics = FlatNetworks([self.target_critics.first, self.target_critics.second], critic)
        self._average_actor = FlatNetworks([self.average_actor], actor)
        self._first_critic = self.flat_critics.first()
        self.actor_optimizer = torch.optim.Adam([self.flat_actor.values], hyper.learning_rate, fused=True)
        self.critic_optimizer = torch.optim.Adam([self.flat_critics.values], hyper.learning_rate, fused=True)

    def _target_actions(self, features: Tensor) -> Tensor:
        return actions(self._target_actor.layers, features[None])[0]

    def _target_returns(self, features: Tensor, action: Tensor) -> tuple[Tensor, Tensor]:
        values, _ = forward(self._target_critics.layers, _for_twins(features, action))
        return values[0], values[1]

    @torch.no_grad()
    def _update_critics(self, batch: Batch, alpha: float, weights: Tensor) -> None:
        y = self.targets(batch, alpha, weights)
        values, saved = forward(self.flat_critics.layers, _for_twins(batch.features, batch.action))
        error = values - y
        self._sums[0].add_(error.square().sum() / len(y))
        self._sums[2].add_((values[0] @ weights).mean())
        backward(self.flat_critics.layers, self.flat_critics.slopes, saved, error.mul_(2.0 / len(y)))
        adam_step(self.critic_optimizer)
        self._counts[0] += 1

    @torch.no_grad()
    def _update_actor(self, batch: Batch, weights: Tensor) -> None:
        """Deterministic policy gradient, Eq. (3), as two chained backward passes."""
        raw, hidden = forward(self.flat_actor.layers, batch.features[None])
        action = raw.tanh_()
        values, saved = forward(self._first_critic, torch.cat((batch.features[None], action), dim=2))
        # The loss is minus the mean value, so every row pulls with -1/K, weighted by return.
        pull = (-weights / values.shape[1]).expand(values.shape)
        slope = action_slope(self._first_critic, saved, pull)
        backward(self.flat_actor.layers, self.flat_actor.slopes, hidden, slope * (1.0 - action * action))
        adam_step(self.actor_optimizer)
        self._sums[1].sub_((values[0] @ weights).mean())
        self._counts[1] += 1

    @torch.no_grad()
    def _update_targets(self) -> None:
        polyak, actor_share = self.hyper.polyak, 1.0 - self.hyper.actor_average
        self._target_actor.values.lerp_(self.flat_actor.values, polyak)
        self._target_critics.values.lerp_(self.flat_critics.values, polyak)
        self._average_actor.values.lerp_(self.flat_actor.values, actor_share)

    def arrays(self) -> Arrays:
        """As `Td3.arrays`; moments in the order of the modules' parameters, whatever the order in memory."""
        arrays = super().arrays()
        for name, networks in self._moments(arrays):
            arrays[name] = array_of(networks.to_modules(tensor_of(arrays[name])))
        return arrays

    def restore(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """As `Td3.restore`."""
        moved = {name: array_of(flat.from_modules(tensor_of(arrays[name]))) for name, flat in self._moments(arrays)}
        super().restore({**arrays, **moved})

    def _moments(self, arrays: Mapping[str, Any]) -> list[tuple[str, FlatNetworks]]:
        pairs = (("actor_optimizer", self.flat_actor), ("critic_optimizer", self.flat_critics))
        names = [(f"{optimizer}/0/{moment}", flat) for optimizer, flat in pairs for moment in MOMENTS]
        return [(name, flat) for name, flat in names if name in arrays]


def _for_twins(features: Tensor, action: Tensor) -> Tensor:
    """The critics' inputs `[2, K, f + 1]`, the same for both."""
    return torch.cat((features, action), dim=1).expand(2, -1, -1)
