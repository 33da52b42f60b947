"""The replay 𝒟: a ring of packed transitions, allocated once (Algorithm 4, lines 9 and 12)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
import torch
from torch import Tensor

from agents.task import BoolArray, FloatArray

SCALARS: Final = 4
"""Columns beside the two observations: action, reward, imitation reward, terminated."""


class Batch(NamedTuple):
    """K transitions; views into one gathered block."""

    features: Tensor
    """Encoded observations s `[K, f]`."""
    action: Tensor
    """Executed actions a `[K, 1]` as shares of the action limit."""
    reward: Tensor
    """Rewards r `[K]` of the task."""
    imitation: Tensor
    """Imitation rewards r^d `[K]`; α is applied when a batch is used, never when it is stored."""
    terminated: Tensor
    """1.0 where the episode ended for good, 0.0 elsewhere and where it was only cut off, `[K]`."""
    next_features: Tensor
    """Encoded true next observations s' `[K, f]`."""


class Replay:
    """The last `capacity` transitions of all lanes."""

    def __init__(self, capacity: int, features: int) -> None:
        """Allocate room for `capacity` transitions with `features` network inputs."""
        self.capacity = capacity
        self.features = features
        self.size = 0
        self.next_row = 0
        self.rows = torch.empty((capacity, 2 * features + SCALARS), dtype=torch.float32)

    def add(
        self,
        features: FloatArray,
        action: FloatArray,
        reward: FloatArray,
        imitation: FloatArray,
        terminated: BoolArray,
        next_features: FloatArray,
    ) -> None:
        """Store one transition of each of L lanes; the oldest make room. Shapes as in `Batch`, L rows."""
        scalars = np.column_stack((action, reward, imitation, terminated)).astype(np.float32, copy=False)
        block = torch.from_numpy(np.concatenate((features, scalars, next_features), axis=1, dtype=np.float32))
        free = min(len(block), self.capacity - self.next_row)
        self.rows[self.next_row : self.next_row + free] = block[:free]
        self.rows[: len(block) - free] = block[free:]
        self.next_row = (self.next_row + len(block)) % self.capacity
        self.size = min(self.size + len(block), self.capacity)

    def minibatches(self, count: int, batch_size: int, generator: torch.Generator) -> Iterator[Batch]:
        """`count` batches of transitions drawn uniformly with replacement; one gather serves all of them."""
        chosen = torch.randint(self.size, (count * batch_size,), generator=generator)
        for rows in self.rows.index_select(0, chosen).split(batch_size):
            yield self.batch(rows)

    def batch(self, rows: Tensor) -> Batch:
        """Packed rows `[K, 2 f + 4]` by name."""
        f = self.features
        action, reward, imitation, terminated = rows[:, f : f + SCALARS].unbind(dim=1)
        return Batch(rows[:, :f], action[:, None], reward, imitation, terminated, rows[:, f + SCALARS :])
