"""What is saved of a stacked agent is a training by itself, and goes on as one."""

from __future__ import annotations

import dataclasses

import numpy as np
import torch

from agents.config import TrainingConfig
from agents.expert import NavigationExpert
from agents.resume import resume_stage
from agents.stacked.agent import Member
from agents.stacked.departure import learner_of
from agents.stacked.training import StackedTraining
from agents.submas import train
from tests.agents.point_robot import POINT_ROBOT
from tests.agents.recording import Recording
from tests.agents.stacked.stacks import FEATURES, Alone, batches, flat, hyper_for, stack_of, together
from tests.agents.stages import HYPER, stage_for

CONFIG = TrainingConfig(curriculum=True, missiles=2, seed=4)


def test_a_learner_out_of_its_stack_learns_on_as_if_it_had_stayed() -> None:
    hyper = hyper_for()
    stack = stack_of([Alone(hyper, seed) for seed in (4, 5)], hyper)
    each = [batches(place, 9) for place in range(2)]
    for index in range(3):
        stack.update(*together([found[index] for found in each]), torch.tensor([0.2, 0.7]))
    alone = learner_of(stack, 1, np.arange(FEATURES), stage_for())
    assert alone.updates == 3
    draw, given = torch.randn, []
    for index in range(3, 9):
        now = [found[index] for found in each]
        stack.update(*together(now), torch.tensor([0.2, 0.7]))
        given.append(now[1][1])
        try:
            torch.randn = lambda *_args, **_named: given[-1].clone()  # type: ignore[assignment]
            alone.update(now[1][0], 0.7)
        finally:
            torch.randn = draw
    for mine, theirs in (
        (stack.actor.values[1, 0], flat(alone.actor)),
        (stack.critics.values[1, 1], flat(alone.critics.second)),
        (stack.target_critics[1, 0], flat(alone.target_critics.first)),
        (stack.average_actor[1, 0], flat(alone.average_actor)),
    ):
        torch.testing.assert_close(mine, theirs, rtol=1e-5, atol=1e-5)


def _interrupted() -> tuple[Recording, StackedTraining]:
    recordings = [Recording(), Recording()]
    for one in recordings:
        one.keep_snapshots = True
    configs = [TrainingConfig(missiles=2, seed=1), CONFIG]
    members = [Member(config, one, NavigationExpert()) for config, one in zip(configs, recordings, strict=True)]
    training = StackedTraining(members, domain=POINT_ROBOT, hyperparameters=dataclasses.replace(HYPER, epochs=3))
    training.run_epoch()
    training.close_epoch()
    return recordings[1], training


def test_a_snapshot_holds_the_agent_as_it_stood() -> None:
    recording, training = _interrupted()
    (snapshot,) = recording.snapshots
    stage, agent, lanes = training.agents[1].stage, training.agents[1], training.stack.lanes
    state = resume_stage(stage, snapshot)
    assert (state.epoch, state.env_steps, state.alpha, state.beta) == (1, 200, agent.state.alpha, agent.state.beta)
    columns = training.stack.encoder.columns(POINT_ROBOT.features(stage.task.layout))
    np.testing.assert_array_equal(state.features, lanes.features[1][:, columns].numpy())
    np.testing.assert_array_equal(state.observation, training.stack.worlds.worlds[1]._observe())
    assert state.replay.size == 200
    np.testing.assert_allclose(
        state.learner.actor(torch.from_numpy(state.features)).detach(),
        training.stack.learner.act(lanes.features)[1], rtol=1e-5, atol=1e-6,
    )  # fmt: skip
    mine, wide, count = state.replay.rows[192:200], training.stack.replay.rows[1, 192:200], len(columns)
    f = training.stack.encoder.features.size
    assert torch.equal(mine[:, :count], wide[:, :f][:, columns])
    assert torch.equal(mine[:, count:-count], wide[:, f:-f])
    assert torch.equal(mine[:, -count:], wide[:, -f:][:, columns])


def test_a_stacked_training_is_resumed_by_itself_to_its_end() -> None:
    recording, _ = _interrupted()
    rest = Recording()
    policy = train(CONFIG, rest, NavigationExpert(), domain=POINT_ROBOT, snapshot=recording.snapshots[0])
    assert [(row["stage"], row["epoch"]) for row in rest.rows] == [(0, 2), (0, 3), (1, 1), (1, 2), (1, 3)]
    assert policy.name == "submas-target" and rest.rows[0]["env_steps"] == 400
    assert rest.rows[0]["updates"] > recording.rows[0]["updates"]
