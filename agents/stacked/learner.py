"""TD3 of S agents in one set of tensors: equal to S learners `agents.td3_fast.FastTd3` up to rounding.

All agents share sizes and numbers (`Hyperparameters`); networks, moments, counts of updates and α are their own. An
agent whose task has fewer subtasks than the widest one sees zeros in the columns of the others: a weight behind a zero
has gradient zero and stays zero, so its network is the smaller one, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor

from agents.hyperparameters import Hyperparameters
from agents.layers import layers_of, shapes_of
from agents.passes import action_slope, actions, backward, forward
from agents.replay import Batch
from agents.stacked.parameters import Group, put_back


class StackedTd3:
    """Networks, targets and moments of S agents `[S, …]`; `update` makes one gradient step of each."""

    def __init__(
        self,
        agents: int,
        features: int,
        hyper: Hyperparameters,
        action_limit: float,
        device: torch.device | str = "cpu",
        dtype: torch.dtype = torch.float32,
    ) -> None:
        """Room for `agents` with `features` inputs; `agents.stacked.residence.move_in` gives each its networks."""
        self.agents, self.features, self.hyper, self.action_limit = agents, features, hyper, action_limit
        self.device, self.dtype = torch.device(device), dtype
        actor, critic = shapes_of(features, hyper)
        self.actor = Group(agents, 1, actor, self.device, dtype)
        self.critics = Group(agents, 2, critic, self.device, dtype)
        self.target_actor, self.average_actor = (torch.zeros_like(self.actor.values) for _ in range(2))
        self.target_critics = torch.zeros_like(self.critics.values)
        self.first_critics = layers_of(self.critics.values[:, 0], critic)
        self._target_actor = layers_of(self.target_actor.view(-1, actor.size), actor)
        self._target_critics = layers_of(self.target_critics.view(-1, critic.size), critic)
        self.critic_sums = torch.zeros((agents, 2), device=self.device, dtype=dtype)
        """Losses and values of the critics since they were last taken `[S, 2]`."""
        self.actor_sums = torch.zeros(agents, device=self.device, dtype=dtype)
        """Losses of the actor, likewise `[S]`."""
        self.updates = np.zeros(agents, np.int64)
        """Gradient steps of the critics `[S]`; on the host, where the delay of the actor is decided."""

    @torch.no_grad()
    def update(self, batch: Batch, noise: Tensor, alpha: Tensor, waiting: Sequence[int] = ()) -> None:
        """One critic step of every agent, and of those whose turn it is one actor and target step.

        Algorithm 4, lines 13-21, for all agents at once.

        Args:
            batch: as in `agents.replay`, with the agents in front: `[S, K, …]`.
            noise: standard normal numbers of the target policy smoothing `[S, K, 1]`.
            alpha: weight of distillation of every agent `[S]`.
            waiting: agents that take no part: nothing of theirs changes by one bit.
        """
        weights = self.weights(alpha)
        with put_back(waiting, [*self.critics.tensors, self.critic_sums]):
            self._update_critics(batch, noise, alpha, weights)
        self.updates += 1
        self.updates[list(waiting)] -= 1
        due = self.updates % self.hyper.policy_delay == 0
        due[list(waiting)] = False
        if due.any():
            with put_back(np.flatnonzero(~due).tolist(), self._delayed):
                self._update_actor(batch, weights)
                self._update_targets()

    @property
    def _delayed(self) -> list[Tensor]:
        """What changes only every `policy_delay`-th time."""
        averages = [self.target_actor, self.target_critics, self.average_actor]
        return [*self.actor.tensors, *averages, self.actor_sums]

    @property
    def tensors(self) -> list[Tensor]:
        """Everything that changes, agents first."""
        return [*self._delayed, *self.critics.tensors, self.critic_sums]

    def weights(self, alpha: Tensor) -> Tensor:
        """How the critics' returns add up to Q `[S, n]`: (1, α) for two returns, else (1,)."""
        ones = torch.ones_like(alpha)
        return torch.stack((ones, alpha), dim=1) if self.hyper.two_returns else ones[:, None]

    def rewards(self, batch: Batch, alpha: Tensor) -> Tensor:
        """Rewards behind the critics' returns `[S, K, n]`: r and r^d, or their sum of Eq. (14)."""
        if self.hyper.two_returns:
            rewards = torch.stack((batch.reward, batch.imitation), dim=2)
        else:
            rewards = (batch.reward + alpha[:, None] * batch.imitation)[..., None]
        return rewards * self.hyper.reward_scale

    def targets(self, batch: Batch, noise: Tensor, alpha: Tensor, weights: Tensor) -> Tensor:
        """Targets y of both critics `[S, K, n]` (Algorithm 4, lines 13-14; Eq. 4)."""
        bound = self.hyper.target_noise_clip / self.action_limit
        noise = (noise * (self.hyper.target_noise / self.action_limit)).clamp(-bound, bound)
        action = actions(self._target_actor, batch.next_features).add_(noise).clamp_(-1.0, 1.0)
        inputs = torch.cat((batch.next_features, action), dim=2)
        values = self._by_twin(forward(self._target_critics, self._for_twins(inputs))[0])
        first, second = values.unbind(dim=1)
        lower = self._summed(first, weights) <= self._summed(second, weights)
        next_value = torch.where(lower[..., None], first, second)
        return self.rewards(batch, alpha) + batch.discount[..., None] * next_value

    def _update_critics(self, batch: Batch, noise: Tensor, alpha: Tensor, weights: Tensor) -> None:
        y = self.targets(batch, noise, alpha, weights)
        inputs = torch.cat((batch.features, batch.action), dim=2)
        values, saved = forward(self.critics.layers, self._for_twins(inputs))
        rows = values.shape[1]
        error = values - self._for_twins(y)
        self.critic_sums[:, 0] += self._by_twin(error).square().sum(dim=(1, 2, 3)) / rows
        self.critic_sums[:, 1] += self._summed(self._by_twin(values)[:, 0], weights).mean(dim=1)
        backward(self.critics.layers, self.critics.slopes, saved, error.mul_(2.0 / rows))
        self.critics.step(self.hyper.learning_rate)

    def _update_actor(self, batch: Batch, weights: Tensor) -> None:
        """Deterministic policy gradient, Eq. (3), as two chained backward passes."""
        raw, hidden = forward(self.actor.layers, batch.features)
        action = raw.tanh_()
        values, saved = forward(self.first_critics, torch.cat((batch.features, action), dim=2))
        rows = values.shape[1]
        # The loss is minus the mean value, so every row pulls with -1/K, weighted by return.
        pull = (-weights / rows)[:, None].expand(-1, rows, -1)
        slope = action_slope(self.first_critics, saved, pull)
        backward(self.actor.layers, self.actor.slopes, hidden, slope * (1.0 - action * action))
        self.actor.step(self.hyper.learning_rate)
        self.actor_sums -= self._summed(values, weights).mean(dim=1)

    def _update_targets(self) -> None:
        """Move targets by τ (Algorithm 4, lines 19-20), and the averaged actors by their own decay."""
        self.target_actor.lerp_(self.actor.values, self.hyper.polyak)
        self.target_critics.lerp_(self.critics.values, self.hyper.polyak)
        self.average_actor.lerp_(self.actor.values, 1.0 - self.hyper.actor_average)

    @torch.no_grad()
    def act(self, features: Tensor) -> Tensor:
        """μ_k(s) of every agent: actions `[S, L, 1]` in [-1, 1] for features `[S, L, f]`."""
        return actions(self.actor.layers, features)

    def take(self, agents: Sequence[int]) -> StackedTd3:
        """A stack of these agents alone, in this order."""
        other = StackedTd3(
            len(agents), self.features, self.hyper, self.action_limit, device=self.device, dtype=self.dtype
        )
        for mine, theirs in zip(other.tensors, self.tensors, strict=True):
            mine.copy_(theirs[list(agents)])
        other.updates = self.updates[list(agents)].copy()
        return other

    @staticmethod
    def _for_twins(rows: Tensor) -> Tensor:
        """`[S, K, d]` once for each of an agent's two critics `[2 S, K, d]`."""
        return rows[:, None].expand(-1, 2, -1, -1).reshape(-1, *rows.shape[1:])

    @staticmethod
    def _by_twin(values: Tensor) -> Tensor:
        """`[2 S, K, n]` as `[S, 2, K, n]`."""
        return values.view(-1, 2, *values.shape[1:])

    @staticmethod
    def _summed(values: Tensor, weights: Tensor) -> Tensor:
        """Returns `[S, K, n]` added up `[S, K]`."""
        return (values * weights[:, None]).sum(dim=2)
