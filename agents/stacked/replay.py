"""The replays of S agents on the device: one ring of time slots per agent, rows as in `agents.replay`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import torch
from torch import Tensor

from agents.replay import SCALARS, Batch
from agents.stacked.draws import Purpose, uniform
from agents.task import FloatArray


class StackedReplay:
    """The last transitions of every agent's lanes `[S, slots · L, 2 f + 5]`."""

    def __init__(self, agents: int, capacity: int, lanes: int, features: int, device: torch.device | str) -> None:
        """Room for `capacity` transitions per agent (whole time slots) with `features` network inputs."""
        self.lanes, self.features = lanes, features
        self.slots = max(capacity // lanes, 1)
        self.device = torch.device(device)
        self.rows = torch.zeros((agents, self.slots * lanes, 2 * features + SCALARS), device=self.device)
        self.added = np.zeros(agents, np.int64)
        """Time slots stored so far per agent `[S]`, also those that have made room."""
        self.stored = torch.zeros(agents, dtype=torch.int64, device=self.device)
        """The same on the device, where batches are drawn."""
        self._place = torch.arange(agents, device=self.device)
        self._places = list(range(agents))

    @property
    def size(self) -> np.ndarray:
        """Number of stored transitions per agent `[S]`."""
        return np.minimum(self.added, self.slots) * self.lanes

    def clear(self, agent: int) -> None:
        """Forget what one agent stored."""
        self.added[agent] = 0
        self.stored[agent] = 0

    def add(self, features: Tensor, action: Tensor, scalars: Tensor, next_features: Tensor) -> None:
        """Store one transition of each lane of each agent; their oldest slots make room.

        Args:
            features: encoded observations `[S, L, f]`.
            action: executed actions as shares of the action limit `[S, L, 1]`.
            scalars: reward, imitation reward, terminated and over `[S, L, 4]`, see `agents.replay.Replay.add`.
            next_features: encoded true next observations `[S, L, f]`.
        """
        block = torch.cat((features, action, scalars, next_features), dim=2)
        slots = self.rows.view(len(self.rows), self.slots, self.lanes, -1)
        slots[self._place, self.stored % self.slots] = block
        self.added += 1
        self.stored += 1

    def take(self, agents: Sequence[int]) -> StackedReplay:
        """The replays of these agents alone, in this order; the rows stay where they are."""
        chosen = list(agents)
        other = object.__new__(StackedReplay)
        other.__dict__.update(self.__dict__)
        other.added, other.stored = self.added[chosen].copy(), self.stored[chosen].clone()
        other._place = self._place[chosen].clone()
        other._places = [self._places[agent] for agent in chosen]
        return other

    def minibatches(
        self, seeds: Tensor, counts: Tensor, count: int, batch_size: int, steps: int, gamma: float
    ) -> Iterator[Batch]:
        """`count` batches `[S, K, …]`, drawn uniformly with replacement from each agent's own transitions.

        As `agents.replay.Replay.minibatches`, but for the source of the draws, which are counted in `counts` `[S]`.
        """
        draws = uniform(seeds, Purpose.TRANSITIONS, counts, (count * batch_size,))
        filled = self.stored.clamp(max=self.slots)
        # Fewer slots than steps are stored only while nothing has made room yet: paths then end at the newest.
        span = filled.clamp(max=min(steps, self.slots))
        choices = ((filled - span + 1) * self.lanes).clamp(min=1)
        oldest = torch.where(self.stored >= self.slots, self.stored % self.slots, torch.zeros_like(filled))
        first = (draws * choices[:, None]).long() + oldest[:, None] * self.lanes
        whole = self.batch(first, span, min(steps, self.slots), gamma)
        for start in range(0, count * batch_size, batch_size):
            yield Batch(*(part[:, start : start + batch_size] for part in whole))

    def batch(self, first: Tensor, span: Tensor, steps: int, gamma: float) -> Batch:
        """Transitions of up to `steps` steps from rows `first` `[S, B]` on, cut where an episode is over.

        Args:
            first: row of each first step.
            span: steps that an agent's paths may take at most `[S]`.
            steps: the largest of them.
            gamma: discount per step.
        """
        f, agents, rows = self.features, len(first), first.shape[1]
        ahead = torch.arange(steps, device=self.device)
        paths = (first[..., None] + self.lanes * ahead) % (self.slots * self.lanes)
        flat = (self._place[:, None, None] * (self.slots * self.lanes) + paths).view(agents * rows, steps)
        table = self.rows.view(-1, self.rows.shape[2])
        scalars = table[:, f + 1 : f + SCALARS][flat.flatten()].view(agents, rows, steps, SCALARS - 1)
        reward, imitation, terminated, over = scalars.unbind(dim=3)
        running = torch.cat((torch.ones_like(over[..., :1]), (1.0 - over[..., :-1]).cumprod(dim=2)), dim=2)
        running = running * (ahead < span[:, None, None])
        weights = running * gamma**ahead
        length = running.sum(dim=2).long().clamp(min=1)
        last = length[..., None] - 1
        discount = (1.0 - terminated.gather(2, last)[..., 0]) * gamma**length
        head = table[flat[:, 0]].view(agents, rows, -1)
        tail = table[flat.view(agents, rows, steps).gather(2, last).flatten()].view(agents, rows, -1)
        sums = (weights * reward).sum(dim=2), (weights * imitation).sum(dim=2)
        return Batch(head[..., :f], head[..., f : f + 1], *sums, discount, tail[..., f + SCALARS :])

    def blocks(self, agent: int, first: int) -> Iterator[tuple[int, FloatArray]]:
        """One agent's stored transitions from time slot number `first` on, as `agents.replay.Replay.blocks`; copies."""
        added, rows = int(self.added[agent]), self.rows[self._places[agent]]
        first = max(first, added - self.slots)
        while first < added:
            row = first % self.slots
            count = min(added - first, self.slots - row)
            yield first, rows[row * self.lanes : (row + count) * self.lanes].cpu().numpy()
            first += count
