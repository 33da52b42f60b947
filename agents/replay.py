"""The replay 𝒟: a ring of packed transitions, allocated once (Algorithm 4, lines 9 and 12)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple, Protocol

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


class StoredSlots(Protocol):
    """Transitions by time slot: a replay, or what was kept of one."""

    @property
    def added(self) -> int:
        """Time slots stored so far."""
        ...

    def blocks(self, first: int) -> Iterator[tuple[int, FloatArray]]:
        """Blocks of consecutive slots from number `first` on, oldest first: number of the first slot, rows."""
        ...


class Replay:
    """The last transitions of all lanes, in a ring of time slots with one row per lane."""

    def __init__(self, capacity: int, lanes: int, features: int) -> None:
        """Allocate room for `capacity` transitions (whole time slots) with `features` network inputs."""
        self.lanes, self.features = lanes, features
        self.slots = max(capacity // lanes, 1)
        self.added = 0
        """Time slots stored so far, also those that have made room."""
        self.filled = 0
        self.next_slot = 0
        self.rows = torch.empty((self.slots * lanes, 2 * features + SCALARS), dtype=torch.float32)
        # A return of many steps reads only these: apart they are a tenth of the memory, and of the time.
        self._scalars = torch.empty((self.slots * lanes, SCALARS - 1), dtype=torch.float32)
        """All of a transition's scalars but the action, once more, by themselves."""

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
        self._scalars[first : first + self.lanes] = torch.from_numpy(scalars[:, 1:])
        self._count(self.added + 1)

    def _count(self, added: int) -> None:
        self.added = added
        self.next_slot = added % self.slots
        self.filled = min(added, self.slots)

    def blocks(self, first: int) -> Iterator[tuple[int, FloatArray]]:
        """Stored transitions from time slot number `first` on, oldest first: slot numbers, rows `[slots · L, 2 f + 5]`.

        Slots that have made room are left out. The rows are views: copy or write them before the next `add`.
        """
        first = max(first, self.added - self.slots)
        while first < self.added:
            row = first % self.slots
            count = min(self.added - first, self.slots - row)
            yield first, self.rows[row * self.lanes : (row + count) * self.lanes].numpy()
            first += count

    def restore(self, stored: StoredSlots) -> None:
        """Take over what `blocks` of another replay gave; every transition lies where it lay there.

        Raises:
            ValueError: transitions of another size, or some are missing.
        """
        wanted = max(stored.added - self.slots, 0)
        for first, rows in stored.blocks(wanted):
            if first > wanted or len(rows) % self.lanes or rows.shape[1] != self.rows.shape[1]:
                raise ValueError(f"transitions {list(rows.shape)} from slot {first} on do not fit or leave a gap")
            self._put(first, torch.from_numpy(rows))
            wanted = max(wanted, first + len(rows) // self.lanes)
        if wanted != stored.added:
            raise ValueError(f"transitions end at slot {wanted} of {stored.added}")
        self._count(stored.added)

    def _put(self, first: int, rows: Tensor) -> None:
        numbers = torch.arange(first, first + len(rows) // self.lanes) % self.slots
        by_slot = rows.view(len(numbers), self.lanes, -1)
        self.rows.view(self.slots, self.lanes, -1)[numbers] = by_slot
        scalars = slice(self.features + 1, self.features + SCALARS)
        self._scalars.view(self.slots, self.lanes, -1)[numbers] = by_slot[..., scalars]

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
        # index_select copies row by row, several times as fast as indexing, which goes number by number.
        scalars = self._scalars.index_select(0, paths.flatten()).view(*paths.shape, SCALARS - 1)
        reward, imitation, terminated, over = scalars.unbind(dim=2)
        running = torch.cat((torch.ones_like(over[:, :1]), (1.0 - over[:, :-1]).cumprod(dim=1)), dim=1)
        weights = running * gamma ** torch.arange(paths.shape[1])
        length = running.sum(dim=1).long()
        last = length[:, None] - 1
        discount = (1.0 - terminated.gather(1, last)[:, 0]) * gamma**length
        head = self.rows.index_select(0, paths[:, 0])
        tail = self.rows.index_select(0, paths.gather(1, last)[:, 0]) if paths.shape[1] > 1 else head
        sums = (weights * reward).sum(dim=1), (weights * imitation).sum(dim=1)
        return Batch(head[:, :f], head[:, f : f + 1], *sums, discount, tail[:, f + SCALARS :])
