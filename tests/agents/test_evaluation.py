"""The evaluator: every episode once, whatever the number of lanes; figures that add up."""

from __future__ import annotations

import json
from dataclasses import fields, replace

import numpy as np
import pytest

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation, evaluate, wilson_interval
from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy
from agents.policy import bind
from sim.task import task_for
from sim.trajectory import fly
from tests.agents.clock import Clock, ClockTask
from tests.agents.point_robot import POINT_ROBOT, RobotTask

KEYS = {
    "policy", "mask", "missiles", "scenario", "episodes", "seed", "success_rate", "success_ci95", "mean_return",
    "mean_length_s", "outcomes", "missiles_evaded_mean", "env_steps_per_s",
}  # fmt: skip


def _robot(lanes: int | None = None, **more: int) -> Evaluation:
    return evaluate(DraggingExpert(1.2), RobotTask(), 60, 5, lanes, domain=POINT_ROBOT, **more)


@pytest.mark.parametrize("lanes", [1, 7, 60, 200])
def test_the_result_does_not_depend_on_the_number_of_lanes(lanes: int) -> None:
    one, other = _robot().results, _robot(lanes).results
    assert one is not None and other is not None
    for name in ("episode", "outcome", "killer", "episode_return", "steps", "solved"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_later_episodes_continue_the_earlier_ones() -> None:
    whole, tail = _robot().results, _robot(first_episode=20).results
    assert whole is not None and tail is not None
    np.testing.assert_array_equal(whole.episode_return[20:], tail.episode_return[:40])
    assert tail.episode.tolist() == list(range(20, 80))


def test_figures_add_up() -> None:
    evaluation = _robot()
    results = evaluation.results
    assert results is not None
    assert sum(evaluation.outcomes.values()) == evaluation.episodes == 60
    assert evaluation.outcomes["exit"] / 60 == evaluation.success_rate == results.success.mean()
    low, high = evaluation.success_ci95
    assert 0.0 <= low <= evaluation.success_rate <= high <= 1.0
    assert evaluation.mean_length_s == pytest.approx(results.steps.mean())
    assert evaluation.mean_return == pytest.approx(results.episode_return.mean(), rel=1e-5)


def test_short_episodes_are_not_favoured() -> None:
    results = evaluate(RandomPolicy(), ClockTask(), 33, 0, 4, domain=Clock(limit=8)).results
    assert results is not None and len(results.steps) == 33 and (results.outcome == 4).all()


def test_the_json_has_exactly_the_agreed_keys() -> None:
    progress: list[tuple[int, int]] = []
    task = task_for("default", "1,2,3,4")
    evaluation = evaluate(NavigationExpert(), task, 4, 1, progress=lambda done, total: progress.append((done, total)))
    values = json.loads(json.dumps(evaluation.to_json(), allow_nan=False))
    assert set(values) == KEYS
    assert values["policy"] == "expert-navigation"
    assert values["mask"] == [1, 2, 3, 4] and values["missiles"] == [] and values["episodes"] == 4
    assert set(values["outcomes"]) == {"exit", "shot_down", "left_field", "timeout", "not_finite"}
    assert progress[-1] == (4, 4)


def test_the_closest_approach_is_that_of_the_recorded_flight() -> None:
    task = task_for("default", "3,4")
    results = evaluate(DraggingExpert(), task, 6, 2, 4).results
    assert results is not None
    flights = [fly(task, bind(DraggingExpert(), task), "", 2, episode) for episode in results.episode]
    nearest = [min(missile.closest_m for missile in flight.missiles) for flight in flights]
    np.testing.assert_allclose(results.closest_m, nearest, atol=0.01)
    none = evaluate(NavigationExpert(), task_for("default", "1,2,3,4"), 2, 2).results
    assert none is not None and np.isposinf(none.closest_m).all()


def test_nothing_to_evaluate_is_an_error() -> None:
    with pytest.raises(ValueError, match="episodes is 0"):
        evaluate(NavigationExpert(), RobotTask(), 0, 1, domain=POINT_ROBOT)


@pytest.mark.parametrize(
    ("successes", "low", "high"), [(948, 0.932, 0.960), (621, 0.591, 0.651), (0, 0.0, 0.0038), (1000, 0.9962, 1.0)]
)
def test_wilson_intervals_of_a_thousand(successes: int, low: float, high: float) -> None:
    assert wilson_interval(successes, 1000) == (pytest.approx(low, abs=6e-4), pytest.approx(high, abs=6e-4))


def test_parts_flown_at_the_same_time_are_the_whole() -> None:
    told: list[tuple[int, int]] = []
    task = task_for("default", "2,3,4")
    whole, parts = (
        evaluate(
            DraggingExpert(), task, 23, 4, threads=threads, progress=lambda *done: told.append(done), first_episode=7
        )
        for threads in (1, 3)
    )
    assert whole.results is not None and parts.results is not None
    for one in fields(EpisodeResults):
        np.testing.assert_array_equal(getattr(whole.results, one.name), getattr(parts.results, one.name))
    assert replace(whole, env_steps_per_s=0.0) == replace(parts, env_steps_per_s=0.0)
    assert told[-1] == (23, 23)
    assert all(total == 23 for _, total in told)


def test_more_threads_than_episodes_fly_each_once() -> None:
    results = evaluate(NavigationExpert(), task_for("default", "1,2,3,4"), 2, 1, threads=5).results
    assert results is not None
    assert results.episode.tolist() == [0, 1]
