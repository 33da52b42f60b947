"""The replay 𝒟: a ring of packed transitions, allocated once (Algorithm 4, lines 9 and 12)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
import torch
from torch import Tensor

from agents.task import BoolArray, FloatArray

SCALARS: Final = 5
"""Columns beside the two observations: action, reward, imitation reward, terminated, over."""


class Batch(NamedTuple):
    """K transitions of up to n steps; views into gathered blocks."""

    features: Tensor
    """Encoded observations s `[K, f]`."""
    action: Tensor
    """Executed actions a `[K, 1]` as shares of the action limit."""
    reward: Tensor
    """Rewards r `[K]` of the task, discounted and summed over the steps."""
    imitation: Tensor
    """Imitation rewards r^d `[K]`, likewise; α is applied when a batch is used, never when it is stored."""
    discount: Tensor
    """Factor on the value of what follows `[K]`: γ to the number of steps, 0 where the episode ended for good."""
    next_features: Tensor
    """Encoded true observations s' `[K, f]` after the last of the steps."""


class Replay:
    """The last transitions of all lanes, in a ring of time slots with one row per lane."""

    def __init__(self, capacity: int, lanes: int, features: int) -> None:
        """Allocate room for `capacity` transitions (whole time slots) with `features` network inputs."""
        self.lanes, self.features = lanes, features
        self.slots = max(capacity // lanes, 1)
        self.filled = 0
        self.next_slot = 0
        self.rows = torch.empty((self.slots * lanes, 2 * features + SCALARS), dtype=torch.float32)

    @property
    def size(self) -> int:
        """Number of stored transitions."""
        return self.filled * self.lanes

    def add(
        self,
        features: FloatArray,
        action: FloatArray,
        reward: FloatArray,
        imitation: FloatArray,
        terminated: BoolArray,
        over: BoolArray,
        next_features: FloatArray,
    ) -> None:
        """Store one transition of each lane; the oldest slot makes room. Shapes as in `Batch`, L rows.

        `over` marks the last transition of an episode, terminated or cut off: no n-step return runs past it.
        """
        scalars = np.column_stack((action, reward, imitation, terminated, over)).astype(np.float32, copy=False)
        block = np.concatenate((features, scalars, next_features), axis=1, dtype=np.float32)
        first = self.next_slot * self.lanes
        self.rows[first : first + self.lanes] = torch.from_numpy(block)
        self.next_slot = (self.next_slot + 1) % self.slots
        self.filled = min(self.filled + 1, self.slots)

    def minibatches(
        self, count: int, batch_size: int, steps: int, gamma: float, generator: torch.Generator
    ) -> Iterator[Batch]:
        """`count` batches drawn uniformly with replacement, each transition spanning up to `steps` steps.

        The newest `steps - 1` slots are not yet complete and wait.
        """
        steps = min(steps, self.filled)
        chosen = torch.randint((self.filled - steps + 1) * self.lanes, (count * batch_size,), generator=generator)
        oldest = self.next_slot if self.filled == self.slots else 0
        first = chosen + oldest * self.lanes
        paths = (first[:, None] + self.lanes * torch.arange(steps)) % len(self.rows)
        whole = self.batch(paths, gamma)
        for start in range(0, count * batch_size, batch_size):
            yield Batch(*(part[start : start + batch_size] for part in whole))

    def batch(self, paths: Tensor, gamma: float) -> Batch:
        """Transitions along rows `[K, n]` of consecutive steps, cut where an episode is over."""
        f = self.features
        scalars = self.rows[:, f + 1 : f + SCALARS][paths.flatten()].view(*paths.shape, SCALARS - 1)
        reward, imitation, terminated, over = scalars.unbind(dim=2)
        running = torch.cat((torch.ones_like(over[:, :1]), (1.0 - over[:, :-1]).cumprod(dim=1)), dim=1)
        weights = running * gamma ** torch.arange(paths.shape[1])
        length = running.sum(dim=1).long()
        last = length[:, None] - 1
        discount = (1.0 - terminated.gather(1, last)[:, 0]) * gamma**length
        head, tail = self.rows[paths[:, 0]], self.rows[paths.gather(1, last)[:, 0]]
        sums = (weights * reward).sum(dim=1), (weights * imitation).sum(dim=1)
        return Batch(head[:, :f], head[:, f : f + 1], *sums, discount, tail[:, f + SCALARS :])
