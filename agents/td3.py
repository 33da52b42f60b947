"""TD3 (§2.1, Eq. 3-4), readable: autograd, twin critics, delayed policy updates, and distillation by weight α.

The critics estimate either one return, of r + α r^d, or two apart: Q = Q_env + α Q_dist. With two, a change of α
needs no relearning, since each part is learned without it.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import torch
from torch import Tensor, nn

from agents.arrays import Arrays, below, joined
from agents.distillation import distilled_reward
from agents.hyperparameters import Hyperparameters
from agents.networks import Actor, TwinCritic
from agents.replay import Batch
from agents.torch_state import (
    array_of,
    generator_array,
    load_generator,
    load_module,
    load_optimizer,
    module_arrays,
    optimizer_arrays,
    tensor_of,
)

NETWORKS = ("actor", "critics", "target_actor", "target_critics", "average_actor")
OPTIMIZERS = ("actor_optimizer", "critic_optimizer")
Network = TypeVar("Network", bound=nn.Module)


def td_target(reward: Tensor, discount: Tensor, next_value: Tensor) -> Tensor:
    """Target y = r + γ Q'(s', a'): Eq. (4), with nothing to come after a terminal state.

    `reward` and `next_value` are `[K, n]` for n returns; `discount` `[K]` is γ, or γ^m for rewards of m steps, and 0
    after a terminal state. A truncated episode is not terminal.
    """
    return reward + discount[:, None] * next_value


def clipped_double_q(first: Tensor, second: Tensor, weights: Tensor) -> Tensor:
    """The smaller of two critics' estimates, min_i Q_i of Eq. (4), `[K, n]`.

    With several returns one critic is chosen per row by the weighted sum, and gives all of its returns.
    """
    lower = (first @ weights) <= (second @ weights)
    return torch.where(lower[:, None], first, second)


@dataclass(frozen=True)
class LearnerStatistics:
    """Means over the updates since the last call of `take_statistics`."""

    critic_loss: float
    actor_loss: float
    q_mean: float


class Td3:
    """Networks, their targets and optimisers; `update` does one gradient step."""

    def __init__(self, features: int, hyper: Hyperparameters, action_limit: float, seed: int) -> None:
        """Initialise all networks for `features` inputs (Algorithm 4, line 1)."""
        self.hyper = hyper
        self.action_limit = action_limit
        self.updates = 0
        self.generator = torch.Generator().manual_seed(seed)
        outputs = 2 if hyper.two_returns else 1
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.actor = Actor(features, hyper.hidden)
            self.critics = TwinCritic(features, hyper.hidden, outputs, hyper.layer_norm)
        self.target_actor, self.target_critics = _frozen_copy(self.actor), _frozen_copy(self.critics)
        self.average_actor = _frozen_copy(self.actor)
        self.actor_optimizer = torch.optim.Adam(self.actor.parameters(), hyper.learning_rate, fused=True)
        self.critic_optimizer = torch.optim.Adam(self.critics.parameters(), hyper.learning_rate, fused=True)
        self._sums = torch.zeros(3)
        self._counts = [0, 0]

    def update(self, batch: Batch, alpha: float) -> None:
        """One critic step, and every `policy_delay`-th time one actor and target step (Algorithm 4, lines 13-21)."""
        self.updates += 1
        weights = self.weights(alpha)
        self._update_critics(batch, alpha, weights)
        if self.updates % self.hyper.policy_delay == 0:
            self._update_actor(batch, weights)
            self._update_targets()

    def weights(self, alpha: float) -> Tensor:
        """How the critics' returns add up to Q `[n]`: (1, α) for two returns, else (1,)."""
        return torch.tensor([1.0, alpha] if self.hyper.two_returns else [1.0])

    def rewards(self, batch: Batch, alpha: float) -> Tensor:
        """Rewards behind the critics' returns `[K, n]`: r and r^d, or their sum of Eq. (14)."""
        if self.hyper.two_returns:
            rewards = torch.stack((batch.reward, batch.imitation), dim=1)
        else:
            rewards = distilled_reward(batch.reward, batch.imitation, alpha)[:, None]
        return rewards * self.hyper.reward_scale

    @torch.no_grad()
    def targets(self, batch: Batch, alpha: float, weights: Tensor) -> Tensor:
        """Targets y of both critics `[K, n]` (Algorithm 4, lines 13-14)."""
        hyper, shape = self.hyper, batch.action.shape
        noise = torch.randn(shape, generator=self.generator) * (hyper.target_noise / self.action_limit)
        bound = hyper.target_noise_clip / self.action_limit
        action = self._target_actions(batch.next_features).add_(noise.clamp_(-bound, bound)).clamp_(-1.0, 1.0)
        first, second = self._target_returns(batch.next_features, action)
        next_value = clipped_double_q(first, second, weights)
        return td_target(self.rewards(batch, alpha), batch.discount, next_value)

    def _target_actions(self, features: Tensor) -> Tensor:
        return self.target_actor(features)

    def _target_returns(self, features: Tensor, action: Tensor) -> tuple[Tensor, Tensor]:
        return self.target_critics(features, action)

    def _update_critics(self, batch: Batch, alpha: float, weights: Tensor) -> None:
        y = self.targets(batch, alpha, weights)
        first, second = self.critics(batch.features, batch.action)
        loss = ((first - y).square() + (second - y).square()).sum(dim=1).mean()
        self.critic_optimizer.zero_grad()
        loss.backward()
        self.critic_optimizer.step()
        self._sums[0] += loss.detach()
        self._sums[2] += (first.detach() @ weights).mean()
        self._counts[0] += 1

    def _update_actor(self, batch: Batch, weights: Tensor) -> None:
        """Deterministic policy gradient, Eq. (3): ∇_a Q₁(s, a) at a = μ_θ(s), times ∇_θ μ_θ(s)."""
        value = self.critics.first(batch.features, self.actor(batch.features)) @ weights
        loss = -value.mean()
        parameters = list(self.actor.parameters())
        # Asking for the actor's gradients alone keeps autograd from computing the critic's.
        for parameter, gradient in zip(parameters, torch.autograd.grad(loss, parameters), strict=True):
            parameter.grad = gradient
        self.actor_optimizer.step()
        self._sums[1] += loss.detach()
        self._counts[1] += 1

    @torch.no_grad()
    def _update_targets(self) -> None:
        """Move targets by τ (Algorithm 4, lines 19-20), and the averaged actor by its own decay."""
        for target, online in ((self.target_actor, self.actor), (self.target_critics, self.critics)):
            _lerp(target, online, self.hyper.polyak)
        _lerp(self.average_actor, self.actor, 1.0 - self.hyper.actor_average)

    def take_statistics(self) -> LearnerStatistics:
        """Mean losses since the last call; the one place where the learner waits for numbers."""
        critic, actor, q = self._sums.tolist()
        critics, actors = max(self._counts[0], 1), max(self._counts[1], 1)
        self._sums.zero_()
        self._counts = [0, 0]
        scale = self.hyper.reward_scale
        return LearnerStatistics(critic / critics, actor / actors, q / critics / scale)

    def arrays(self) -> Arrays:
        """Copies of everything that changes while learning; see `restore`."""
        networks = {name: module_arrays(getattr(self, name)) for name in NETWORKS}
        optimizers = {name: optimizer_arrays(getattr(self, name)) for name in OPTIMIZERS}
        counters = {"updates": np.array(self.updates), "counts": np.array(self._counts), "sums": array_of(self._sums)}
        return joined(networks | optimizers) | counters | {"generator": generator_array(self.generator)}

    def restore(self, arrays: Arrays) -> None:
        """Go on, bit for bit, from where `arrays` was taken of a learner of the same sizes.

        Raises:
            KeyError, RuntimeError, ValueError: the arrays are not those of such a learner.
        """
        for name in NETWORKS:
            load_module(getattr(self, name), below(name, arrays))
        for name in OPTIMIZERS:
            load_optimizer(getattr(self, name), below(name, arrays))
        load_generator(self.generator, arrays["generator"])
        self.updates, self._counts = int(arrays["updates"]), arrays["counts"].tolist()
        self._sums = tensor_of(arrays["sums"])


def _frozen_copy(module: Network) -> Network:
    return copy.deepcopy(module).requires_grad_(False)


def _lerp(target: nn.Module, online: nn.Module, share: float) -> None:
    library: Any = torch  # the stubs leave the foreach functions out
    library._foreach_lerp_(list(target.parameters()), list(online.parameters()), share)
