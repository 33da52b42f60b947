"""The gradient steps between two steps of all lanes, as one piece: on a GPU they become one CUDA graph.

An update is about a hundred small kernels, and starting each takes longer than running it. A graph starts them all at
once. It is recorded when everybody takes part and everybody's actor has its turn at the same places of the block; in
the few other steps (a stage has just begun) the same code runs kernel by kernel.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from agents.hyperparameters import Hyperparameters
from agents.stacked.draws import Purpose, normal
from agents.stacked.stack import Stack

WARM_UP = 3
"""Blocks that run kernel by kernel before one is recorded: libraries set themselves up in their first calls."""


class UpdateBlock:
    """Draws batches and updates all agents of one stack (Algorithm 4, lines 11-22)."""

    def __init__(self, stack: Stack, hyper: Hyperparameters) -> None:
        self.stack, self.hyper = stack, hyper
        self._graph: Any = None
        self._warm = 0

    def __call__(self, waiting: Sequence[int]) -> None:
        """Run the block; agents that are `waiting` for their first experience take no part."""
        if not self.hyper.updates_per_lane_step:
            return
        if waiting or not self.capturable:
            self._run(waiting)
        elif self._warm < WARM_UP:
            self._warm += 1
            self._run(())
        elif self._graph is None:
            self._graph = torch.cuda.CUDAGraph()
            with torch.cuda.graph(self._graph):
                self._run(())  # records, and counts on the host; nothing is computed yet
            self._graph.replay()
        else:
            self._graph.replay()
            self.stack.learner.updates += self.hyper.updates_per_lane_step

    @property
    def recorded(self) -> bool:
        """Whether it runs as a CUDA graph by now."""
        return self._graph is not None

    @property
    def capturable(self) -> bool:
        """Whether the block is the same sequence of kernels each time, on a device that can record it."""
        learner, hyper = self.stack.learner, self.hyper
        in_step = hyper.updates_per_lane_step % hyper.policy_delay == 0
        return learner.device.type == "cuda" and in_step and not (learner.updates % hyper.policy_delay).any()

    @torch.no_grad()
    def _run(self, waiting: Sequence[int]) -> None:
        stack, hyper = self.stack, self.hyper
        lanes, count = stack.lanes, hyper.updates_per_lane_step
        shape = (count, hyper.batch_size, 1)
        noise = normal(lanes.seeds, Purpose.TARGET_NOISE, lanes.updates, shape).to(stack.learner.dtype)
        batches = stack.replay.minibatches(
            lanes.seeds, lanes.updates, count, hyper.batch_size, hyper.return_steps, hyper.gamma
        )
        for index, batch in enumerate(batches):
            stack.learner.update(batch, noise[:, index], lanes.alpha, waiting)
        lanes.updates += count
        if waiting:
            lanes.updates[list(waiting)] -= count
