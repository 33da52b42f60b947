"""Which policy is kept and when a stage is passed."""

from __future__ import annotations

import dataclasses

import pytest

from agents import knowledge_transfer as algorithm
from agents import promotion
from agents.evaluation import Evaluation, evaluate
from agents.expert import NavigationExpert
from agents.promotion import is_better
from tests.agents.point_robot import POINT_ROBOT, RobotTask
from tests.agents.recording import Recording
from tests.agents.stages import stage_for

ONE = evaluate(NavigationExpert(), RobotTask(), 2, 0, domain=POINT_ROBOT)


def _evaluation(success: float, mean_return: float = 0.0) -> Evaluation:
    return dataclasses.replace(ONE, success_rate=success, mean_return=mean_return)


FRESH = 0.65
"""Success in the episodes that had no part in choosing the policy."""


def _run(monkeypatch: pytest.MonkeyPatch, rates: list[float], recording: Recording, **changes: object) -> None:
    results = iter(rates)
    monkeypatch.setattr(promotion, "evaluate_held_out", lambda *_: _evaluation(next(results)))
    monkeypatch.setattr(algorithm, "run_epoch", _no_work)
    monkeypatch.setattr(algorithm, "judge", lambda *_: _evaluation(FRESH))
    stage = stage_for(epochs=len(rates), promotion_success=0.9, promotion_evaluations=2, **changes)
    algorithm.knowledge_transfer(stage, recording)


def _no_work(stage: object, state: object, collector: object) -> None:
    state.epoch += 1  # type: ignore[attr-defined]


def test_a_stage_is_passed_when_one_policy_is_good_twice_and_not_once(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = Recording()
    # Epoch 1 is not confirmed, epoch 2 not good, epoch 3 is confirmed at once.
    _run(monkeypatch, [0.95, 0.2, 0.85, 0.9, 0.92], recording)
    assert len(recording.rows) == 3
    assert recording.rows[0]["success_rate"] == pytest.approx(0.575)
    (promoted,) = [text for kind, text, _ in recording.events if kind == "promoted"]
    assert "2 held-out evaluations" in promoted and "90.0%" in promoted and "92.0%" in promoted


def test_the_best_policy_is_kept_not_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = Recording()
    _run(monkeypatch, [0.1, 0.7, 0.3], recording)
    kept = [card.evaluation["success_rate"] for _, card in recording.policies if card.evaluation]
    assert kept == [0.1, 0.7, FRESH]
    assert [card.final for _, card in recording.policies] == [False, False, True]
    assert recording.events[-1][2]["success_rate"] == FRESH
    assert "all 3 epochs" in recording.events[-1][1]


def test_a_stop_ends_the_stage_with_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = Recording(stop_after=2)
    _run(monkeypatch, [0.3, 0.1, 0.8], recording)
    assert len(recording.rows) == 2 and recording.kinds()[-2:] == ["stopped", "stage_finished"]
    assert recording.policies[-1][1].final


def test_alpha_and_epsilon_follow_the_evaluation(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = Recording()
    _run(monkeypatch, [0.5, 0.5, 0.0, 0.0], recording, alpha_clip=0.25, epsilon_clip=1.0)
    assert [row["alpha"] for row in recording.rows] == [1.0, 0.75, 0.5, 0.75]
    assert [row["epsilon"] for row in recording.rows] == pytest.approx([0.8, 0.4, 0.4, 0.8])
    assert [row["beta"] for row in recording.rows] == [0.5, 0.5, 0.0, 0.0]


def test_success_comes_before_return() -> None:
    assert is_better(_evaluation(0.5, -100.0), None)
    assert is_better(_evaluation(0.6, -100.0), _evaluation(0.5, 100.0))
    assert is_better(_evaluation(0.5, 101.0), _evaluation(0.5, 100.0))
    assert not is_better(_evaluation(0.5, 100.0), _evaluation(0.5, 100.0))
