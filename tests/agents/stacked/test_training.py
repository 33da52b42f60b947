"""Whole trainings: stacked they are what they are alone, they learn, and each goes its own way."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import torch

from agents.config import ConfigError, TrainingConfig
from agents.evaluation import evaluate
from agents.expert import DraggingExpert, NavigationExpert
from agents.hyperparameters import SMOKE
from agents.policy import Policy
from agents.stacked.agent import Member
from agents.stacked.training import StackedTraining, train_stacked
from agents.stacked.warp_worlds import WarpWorlds
from agents.submas import train
from tests.agents.point_robot import POINT_ROBOT, PointRobot, RobotTask
from tests.agents.recording import Recording
from tests.agents.stacked.counted import count_draws
from tests.agents.stages import HYPER
from tests.agents.test_submas import LEARNING, POORLY_PAID

CONFIGS = [
    TrainingConfig(curriculum=True, missiles=2, seed=0),
    TrainingConfig(curriculum=True, missiles=2, seed=1, variant="wo-pd"),
    TrainingConfig(missiles=2, seed=2, variant="dec-pr"),
]
TIMES = {"updates_per_s", "env_steps_per_s", "wall_s", "cpu_s", "eta_s"}


def stacked(
    configs: Sequence[TrainingConfig],
    recordings: Sequence[Recording],
    guides: Sequence[Policy] | None = None,
    domain: PointRobot = POINT_ROBOT,
    **changes: object,
) -> list[Exception | None]:
    """Train all together on the point robot; what ended each of them."""
    ended: list[Exception | None] = []
    guides = guides or [NavigationExpert()] * len(configs)
    members = [Member(*parts, ended.append) for parts in zip(configs, recordings, guides, strict=True)]
    train_stacked(members, domain=domain, hyperparameters=dataclasses.replace(HYPER, **changes))
    return ended


def _close(mine: list[dict[str, Any]], theirs: list[dict[str, Any]], rel: float) -> None:
    assert len(mine) == len(theirs)
    for ours, alone in zip(mine, theirs, strict=True):
        assert ours.keys() == alone.keys()
        for name in ours.keys() - TIMES:
            same = ours[name] == alone[name] or ours[name] == pytest.approx(alone[name], rel=rel, abs=1e-4)
            assert same, f"{name} of epoch {ours['epoch']}: {ours[name]} is not {alone[name]}"


@pytest.mark.parametrize(
    "changes", [{}, {"noise_steps": 4, "segment_steps": 5, "return_steps": 6, "layer_norm": False}]
)
def test_trainings_together_are_the_same_trainings_alone(
    monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any]
) -> None:
    together, alone = ([Recording() for _ in CONFIGS] for _ in range(2))
    # Different stages, variants, guides and numbers of stages side by side; three updates put turns out of step.
    guides = [NavigationExpert(), NavigationExpert(), DraggingLike()]
    assert stacked(CONFIGS, together, guides, **changes) == [None] * 3
    for config, recording, guide in zip(CONFIGS, alone, guides, strict=True):
        with monkeypatch.context() as patched:
            count_draws(patched)
            hyper = dataclasses.replace(HYPER, **changes)
            train(config, recording, guide, domain=POINT_ROBOT, hyperparameters=hyper)
    for mine, theirs in zip(together, alone, strict=True):
        _close(mine.rows, theirs.rows, rel=2e-3)
        ours = [event for event in mine.events if event[0] != "numerics"]
        assert [event[0] for event in ours] == [event[0] for event in theirs.events if event[0] != "numerics"]
        (policy, card), (other, other_card) = mine.policies[-1], theirs.policies[-1]
        assert dataclasses.replace(card, evaluation=None) == dataclasses.replace(other_card, evaluation=None)
        for (weight, bias), (expected, expected_bias) in zip(policy.layers, other.layers, strict=True):
            np.testing.assert_allclose(weight, expected, rtol=1e-2, atol=1e-4)
            np.testing.assert_allclose(bias, expected_bias, rtol=1e-2, atol=1e-4)


class DraggingLike(DraggingExpert):
    """A rule that a stack does not know, and so asks on the host."""


def test_who_is_stacked_beside_an_agent_does_not_matter() -> None:
    changes = {"updates_per_lane_step": 2, "epochs": 3}
    (first, _, _), (again, _) = ([Recording() for _ in range(n)] for n in (3, 2))
    stacked(CONFIGS, [first, Recording(), Recording()], **changes)
    stacked([CONFIGS[0], TrainingConfig(missiles=1, seed=9)], [again, Recording()], **changes)
    _close(first.rows, again.rows, rel=1e-3)


@pytest.mark.slow
def test_three_seeds_together_solve_the_target_from_an_expert_that_always_fails_there() -> None:
    recordings = [Recording() for _ in range(3)]
    configs = [TrainingConfig(curriculum=True, missiles=2, seed=seed) for seed in range(3)]
    changes = {item.name: getattr(LEARNING, item.name) for item in dataclasses.fields(LEARNING)}
    stacked(configs, recordings, domain=POORLY_PAID, **changes)
    for recording in recordings:
        (policy, _) = recording.policies[-1]
        assert evaluate(policy, RobotTask(), 200, 9, domain=POINT_ROBOT).success_rate >= 0.9
        finished = [fields["task"] for kind, _, fields in recording.events if kind == "stage_finished"]
        assert finished == ["source-1", "target"]
    # Promotion is each agent's own: nobody waited for the slowest.
    assert len({len(recording.rows) for recording in recordings}) > 1


def test_a_promoted_agent_begins_its_next_stage_while_another_still_learns() -> None:
    training = StackedTraining(
        [Member(config, Recording(), NavigationExpert()) for config in CONFIGS[:2]],
        domain=POINT_ROBOT, hyperparameters=dataclasses.replace(HYPER, epochs=3),
    )  # fmt: skip
    training.run_epoch()
    training.agents[0].stage = dataclasses.replace(
        training.agents[0].stage, hyper=dataclasses.replace(training.hyper, promotion_success=0.0)
    )
    updates = int(training.stack.learner.updates[1])
    training.close_epoch()
    assert [agent.stage.task.name for agent in training.agents] == ["target", "source-1"]
    assert training.stack.learner.updates.tolist() == [0, updates]
    assert training.stack.lanes.alpha.tolist() == [1.0, 0.0]
    training.run_epoch()
    assert [agent.state.epoch for agent in training.agents] == [1, 2]


def test_alpha_epsilon_and_beta_move_by_each_agents_own_success() -> None:
    configs = [dataclasses.replace(CONFIGS[0], variant=name) for name in ("submas", "wo-pd", "wo-pr", "dec-pd", "td3")]
    recordings = [Recording() for _ in configs]
    stacked(configs, recordings, epochs=2, updates_per_lane_step=0)
    weights = [[(row["alpha"], row["epsilon"]) for row in one.rows if row["stage"] == 0] for one in recordings]
    betas = [one.rows[0]["beta"] for one in recordings]
    assert betas[0] < 0.6
    alpha, epsilon = max(1.0 - betas[0], 0.75), max(0.8 * (1.0 - betas[0]), 0.55)
    assert weights[0] == [(1.0, 0.8), pytest.approx((alpha, epsilon))]
    assert weights[1] == [(0.0, 0.8), pytest.approx((0.0, epsilon))]
    assert weights[2] == [(1.0, 0.0), pytest.approx((alpha, 0.0))]
    assert weights[3] == [(1.0, 0.8), pytest.approx((0.5, epsilon))]
    assert weights[4] == [(0.0, 0.0)] * 2


def test_a_stopped_agent_leaves_and_the_others_go_on() -> None:
    recordings = [Recording(stop_after=1), Recording()]
    assert stacked(CONFIGS[:2], recordings) == [None, None]
    assert len(recordings[0].rows) == 1 and recordings[0].kinds()[-1] == "stage_finished"
    assert len(recordings[1].rows) == 4


class Full(Recording):
    """A recorder whose disk is full at the second epoch."""

    def epoch(self, row: dict[str, Any]) -> None:
        super().epoch(row)
        if len(self.rows) == 2:
            raise OSError("no space left")


def test_an_agent_that_fails_takes_nobody_with_it() -> None:
    recordings = [Full(), Recording()]
    failed, finished = stacked(CONFIGS[:2], recordings)
    assert isinstance(failed, OSError) and finished is None
    assert (len(recordings[0].rows), len(recordings[1].rows)) == (2, 4)


def test_what_cannot_be_stacked_is_said() -> None:
    with pytest.raises(ConfigError, match="variant 'ppo' cannot be stacked"):
        stacked([TrainingConfig(missiles=1, variant="ppo")], [Recording()])
    with pytest.raises(ConfigError, match="different profiles"):
        configs = [TrainingConfig(missiles=1), TrainingConfig(missiles=1, profile="smoke")]
        train_stacked([Member(config, Recording(), NavigationExpert()) for config in configs])
    with pytest.raises(ConfigError, match="nothing to train"):
        train_stacked([])


def test_the_papers_domain_is_trained_with_the_simulator_beside_the_learner() -> None:
    hyper = dataclasses.replace(SMOKE, steps_per_epoch=256, update_after=64, hidden=(16, 16), evaluation_episodes=4)
    recordings = [Recording() for _ in range(2)]
    configs = [TrainingConfig(missiles=1, profile="smoke"), TrainingConfig(missiles=2, profile="smoke", seed=1)]
    members = [Member(config, one, NavigationExpert()) for config, one in zip(configs, recordings, strict=True)]
    training = StackedTraining(members, hyperparameters=dataclasses.replace(hyper, final_episodes=4))
    assert isinstance(training.stack.worlds, WarpWorlds)
    training.run()
    for recording, missiles in zip(recordings, (1, 2), strict=True):
        assert [row["env_steps"] for row in recording.rows] == [256, 512]
        (policy, card) = recording.policies[-1]
        assert card.final and card.missiles == tuple(range(1, missiles + 1))
        assert policy.act(np.zeros((3, 7 + 2 * missiles), np.float32), policy.layout).shape == (3, 1)


@pytest.mark.gpu
@pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device here")
def test_a_recorded_graph_learns_what_single_kernels_learn(monkeypatch: pytest.MonkeyPatch) -> None:
    from agents.stacked import update_block

    results = []
    for warm_up in (3, 10**9):  # the second never records
        monkeypatch.setattr(update_block, "WARM_UP", warm_up)
        recordings = [Recording() for _ in range(2)]
        members = [Member(CONFIGS[0], recording, NavigationExpert()) for recording in recordings]
        hyper = dataclasses.replace(HYPER, updates_per_lane_step=2)
        train_stacked(members, "cuda:0", domain=POINT_ROBOT, hyperparameters=hyper)
        results.append(recordings[0].rows)
    _close(*results, rel=1e-3)
