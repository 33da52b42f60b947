"""The simulator's worlds of all agents on the learners' device: torch reads and writes Warp's own memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
import warp as wp
from torch import Tensor

from agents.stacked.worlds import LaneStep
from agents.stage import Stage
from agents.task import RUNNING, BoolArray
from sim.device import start_warp
from sim.device_world import DeviceWorld, truth_columns
from sim.observation import ObservationLayout
from sim.world import Outcome


@dataclass(frozen=True)
class Views:
    """One world's arrays as tensors; the same memory."""

    turns: Tensor
    """`[rows]`"""
    truth: Tensor
    """`[rows, 7 + 2 M]`"""
    terms: Tensor
    """`[rows, M + 2]`"""
    outcomes: Tensor
    """`[rows]`"""

    @classmethod
    def of(cls, world: DeviceWorld) -> Views:
        """Tensors that alias the arrays of a world."""
        turns, outcomes = (wp.to_torch(array).view(-1) for array in (world.turns, world.outcomes))
        return cls(turns, wp.to_torch(world.truth), wp.to_torch(world.terms), outcomes)


class WarpWorlds:
    """`Worlds` of the paper's domain, for scenarios with perfect sensors."""

    def __init__(self, layout: ObservationLayout, agents: int, lanes: int, device: torch.device) -> None:
        """Places for `agents`; observations are shown in `layout`, which has the missiles of every task."""
        start_warp()
        self.layout, self.lanes, self.device = layout, lanes, device
        self.worlds: list[Any] = [None] * agents
        self._views: list[Any] = [None] * agents
        self._columns = torch.tensor(truth_columns(layout), device=device)
        alone = device.type == "cpu"
        self._streams = [] if alone else [wp.Stream(warp_device(device)) for _ in range(agents)]

    def open(self, agent: int, stage: Stage) -> Tensor:
        """See `Worlds.open`."""
        world = DeviceWorld(stage.task, self.lanes, stage.seed, device=warp_device(self.device))
        # A training by itself resets its world once more as well, and so begins with episode number L.
        world.restart(np.arange(self.lanes))
        self.worlds[agent], self._views[agent] = world, Views.of(world)
        return self._views[agent].truth[: self.lanes, self._columns]

    def step(self, action: Tensor) -> LaneStep:
        """See `Worlds.step`."""
        for views, turns in zip(self._views, action, strict=True):
            views.turns[: self.lanes] = turns[:, 0]
        self._advance()
        outcome = torch.stack([views.outcomes[: self.lanes] for views in self._views])
        over = outcome != RUNNING  # lanes that ended before have been restarted
        truncated = (outcome == Outcome.TIMEOUT) | (outcome == Outcome.NOT_FINITE)
        reward = torch.stack([views.terms[: self.lanes] for views in self._views]).sum(dim=2)
        return LaneStep(self._observation(), reward, over & ~truncated, over, outcome)

    def restart(self, over: BoolArray) -> Tensor:
        """See `Worlds.restart`."""
        for agent in np.flatnonzero(over.any(axis=1)):
            self.worlds[agent].restart(np.flatnonzero(over[agent]))
        return self._observation()

    def take(self, agents: Sequence[int]) -> WarpWorlds:
        """See `Worlds.take`."""
        other = WarpWorlds(self.layout, len(agents), self.lanes, self.device)
        other.worlds = [self.worlds[agent] for agent in agents]
        other._views = [self._views[agent] for agent in agents]
        return other

    def _observation(self) -> Tensor:
        return torch.stack([views.truth[: self.lanes] for views in self._views])[..., self._columns]

    def _advance(self) -> None:
        """Fly all worlds; on a GPU side by side, each on a stream of its own, for one fills only a part of it."""
        if self.device.type == "cpu":
            for world in self.worlds:
                world.advance()
            return
        main = wp.get_stream(warp_device(self.device))
        for world, stream in zip(self.worlds, self._streams, strict=True):
            stream.wait_stream(main)
            with wp.ScopedStream(stream, sync_enter=False):
                world.advance()
        for stream in self._streams:
            main.wait_stream(stream)


def warp_device(device: torch.device) -> str:
    """Warp's name of a device of torch."""
    return "cpu" if device.type == "cpu" else f"cuda:{device.index or 0}"


@contextmanager
def on_torchs_stream(device: torch.device) -> Iterator[None]:
    """Within the block Warp queues its work where torch does, so that neither overtakes the other on a GPU."""
    if device.type == "cpu":
        yield
        return
    start_warp()
    with wp.ScopedStream(wp.stream_from_torch(torch.cuda.current_stream(device))):
        yield
