"""Trials of the study of stability: what is taken away, and the figures a trial is judged by."""

from __future__ import annotations

import dataclasses

import pytest

from agents.config import ConfigError, TrainingConfig
from agents.expert import NavigationExpert
from agents.hyperparameters import FAST
from agents.remedies import FADE_EPOCHS, REMEDIES, STUDY
from agents.trial import Trial, run_trial
from agents.weights import next_epsilon
from tests.agents.point_robot import POINT_ROBOT
from tests.agents.stages import HYPER


def trial(*success: float) -> Trial:
    epochs = tuple(2 * (index + 1) for index in range(len(success)))
    return Trial(
        remedy="none", seed=0, guide="g", epochs=epochs, success_rate=success, mean_return=success, epsilon=success,
        final_success_rate=1.0, cpu_s=1.0,
    )  # fmt: skip


def test_arrival_is_the_first_evaluation_at_95_percent() -> None:
    assert trial(0.0, 0.94, 0.95, 0.2, 1.0).arrived == 6
    assert trial(0.0, 0.94).arrived is None


def test_the_worst_fall_is_measured_from_the_best_before() -> None:
    assert trial(0.1, 0.9, 0.8, 1.0, 0.35, 0.9, 0.7).worst_fall == pytest.approx(0.65)
    assert trial(0.0, 0.5, 0.5, 1.0).worst_fall == 0.0


def test_late_success_is_the_mean_of_the_last_five() -> None:
    assert trial(0.0, 0.0, 1.0, 0.5, 0.5, 1.0, 1.0).late_success == pytest.approx(0.8)


def test_a_trial_without_evaluations_is_refused() -> None:
    with pytest.raises(ValueError, match="no evaluations"):
        trial()


def test_every_remedy_but_none_takes_one_thing_away_that_fast_has() -> None:
    for name, remedy in REMEDIES.items():
        changed = [
            item.name
            for item in dataclasses.fields(STUDY)
            if getattr(remedy.hyperparameters, item.name) != getattr(STUDY, item.name)
        ]
        assert changed == list(remedy.without) and len(changed) == (name != "none"), name
        assert all(getattr(FAST, item) == getattr(STUDY, item) for item in remedy.without), name


def test_in_a_study_the_guide_can_be_gone_before_the_end_and_no_stage_ends_early() -> None:
    epsilon = STUDY.epsilon_start
    for epoch in range(1, FADE_EPOCHS + 1):
        epsilon = next_epsilon(epsilon, 1.0, STUDY.epsilon_start, STUDY.epsilon_clip, "adaptive", epoch, STUDY.epochs)
    assert epsilon == pytest.approx(0.0, abs=1e-9) and STUDY.epochs > FADE_EPOCHS
    assert STUDY.promotion_success > 1.0


def test_a_trial_reports_every_held_out_evaluation_and_the_fresh_one() -> None:
    told: list[tuple[int, int]] = []
    config = TrainingConfig(missiles=1)
    found = run_trial(
        "none", 3, NavigationExpert(), lambda done, of: told.append((done, of)),
        config=config, domain=POINT_ROBOT, hyperparameters=HYPER,
    )  # fmt: skip
    assert found.epochs == (1, 2) and told == [(1, 2), (2, 2)]
    assert len(found.success_rate) == len(found.mean_return) == len(found.epsilon) == 2
    assert found.seed == 3 and 0.0 <= found.final_success_rate <= 1.0 and found.cpu_s > 0.0


def test_an_unknown_remedy_is_named() -> None:
    with pytest.raises(ConfigError, match="remedy 'prayer' is unknown; known are none, one-step"):
        run_trial("prayer", 0, NavigationExpert(), lambda _done, _of: None)
