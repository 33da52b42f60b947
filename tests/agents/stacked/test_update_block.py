"""Recording and replaying a block of updates, with a stand-in for the graph: nothing is counted twice or left out."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import Any

import pytest
import torch

from agents.config import TrainingConfig
from agents.expert import NavigationExpert
from agents.recorder import NoRecorder
from agents.stacked.agent import Member
from agents.stacked.training import StackedTraining
from agents.stacked.update_block import WARM_UP, UpdateBlock
from tests.agents.point_robot import POINT_ROBOT
from tests.agents.stages import HYPER

EVEN = dataclasses.replace(HYPER, updates_per_lane_step=4)
BLOCKS = 9


def _training() -> StackedTraining:
    members = [Member(TrainingConfig(missiles=2, seed=seed), NoRecorder(), NavigationExpert()) for seed in range(2)]
    training = StackedTraining(members, domain=POINT_ROBOT, hyperparameters=EVEN)
    while training.stack.learner.updates.min() == 0:
        training.step()
    return training


class StandIn:
    """Behaves as a CUDA graph: while it is recorded nothing is computed, and a replay computes on the device alone."""

    def __init__(self, block: UpdateBlock) -> None:
        self.block, self.replays = block, 0

    @contextlib.contextmanager
    def recording(self, _graph: Any) -> Iterator[None]:
        stack = self.block.stack
        tensors = [*stack.learner.tensors, stack.lanes.updates]
        kept = [tensor.clone() for tensor in tensors]
        yield
        for tensor, before in zip(tensors, kept, strict=True):
            tensor.copy_(before)

    def replay(self) -> None:
        self.replays += 1
        learner = self.block.stack.learner
        counted = learner.updates.copy()
        learner.updates -= EVEN.updates_per_lane_step  # the turns of actors are those of the recording
        self.block._run(())
        learner.updates[:] = counted


def test_a_recorded_block_counts_and_learns_as_single_kernels_do(monkeypatch: pytest.MonkeyPatch) -> None:
    plain, recorded = _training(), _training()
    graph = StandIn(recorded.block)
    monkeypatch.setattr(torch.cuda, "CUDAGraph", lambda: graph)
    monkeypatch.setattr(torch.cuda, "graph", graph.recording)
    for number in range(BLOCKS):
        plain.block(())
        with monkeypatch.context() as on_a_card:
            on_a_card.setattr(UpdateBlock, "capturable", True)
            recorded.block(())
        assert recorded.block.recorded == (number >= WARM_UP)
        assert recorded.stack.learner.updates.tolist() == plain.stack.learner.updates.tolist()
        assert torch.equal(recorded.stack.lanes.updates, plain.stack.lanes.updates)
    assert graph.replays == BLOCKS - WARM_UP
    for mine, theirs in zip(recorded.stack.learner.tensors, plain.stack.learner.tensors, strict=True):
        assert torch.equal(mine, theirs)


def test_only_a_card_and_turns_in_step_are_recorded() -> None:
    training = _training()
    assert not training.block.capturable
    training.stack.learner.device = torch.device("cuda")
    assert training.block.capturable
    training.stack.learner.updates[1] += 1
    assert not training.block.capturable
    training.stack.learner.updates[1] += 1
    training.block.hyper = HYPER  # three updates between two turns of the actor at every second one
    assert not training.block.capturable


def test_the_host_and_the_device_count_the_same_updates() -> None:
    training = _training()
    training.block([1])
    assert training.stack.lanes.updates.tolist() == training.stack.learner.updates.tolist()
    assert training.stack.learner.updates[0] == training.stack.learner.updates[1] + EVEN.updates_per_lane_step
