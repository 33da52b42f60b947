"""Law: reward terms sum to the reward and masked terms vanish (Eq. 9-12), in worlds with any numbers and any mask."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest

from sim.observation import is_default, keep_masked
from sim.reward import GOAL, masked_reward, source_reward, total_reward
from sim.task import Task
from sim.world import Fate, Outcome, World
from tests.engagements import Flights, changed, drag, fly_lanes
from tests.laws.random_worlds import tame_task
from tests.laws.records import SCENARIOS, hard_turns

WORLDS, LANES, STEPS = range(40), 24, 150


@cache
def flown(number: int) -> tuple[Task, Flights, np.ndarray]:
    """One random world's task, flights, and the reward `[K, L]` that its steps told."""
    task = tame_task(np.random.default_rng(number))
    world, turns = World(task, LANES, seed=number), hard_turns(STEPS, LANES, seed=number)
    flights, told = fly_lanes(world, turns, steps=STEPS), World(task, LANES, seed=number)
    return task, flights, np.stack([told.step(turn).reward for turn in turns])


def sums_to(terms: np.ndarray, reward: np.ndarray) -> bool:
    """Eq. (9), to the rounding of float32."""
    return bool(np.allclose(total_reward(terms.astype(np.float64)), reward, rtol=1e-6, atol=1e-6))


def masked_vanish(terms: np.ndarray, task: Task) -> bool:
    """Eq. (11), (12): nothing is ever paid for a missile that the task has not; exactly."""
    masked = sorted(task.masked)
    return not terms[..., masked].any() and not masked_reward(terms, masked).any()


def paid_by_fate(task: Task, flights: Flights) -> bool:
    """Every term, summed over the flight, is what the ends of missiles and of the episode are worth, and no more."""
    reward = task.scenario.reward
    worth = np.zeros(len(Fate))
    worth[[Fate.EVADED, Fate.HIT]] = reward.evaded, reward.shot_down
    goal = np.zeros(len(Outcome))
    goal[[Outcome.EXIT, Outcome.LEFT_FIELD]] = reward.exit, reward.shot_down
    paid = flights.terms.sum(axis=0, dtype=np.float64)
    expected = np.column_stack([goal[flights.outcome], worth[flights.fates[-1]], reward.step * flights.steps])
    return bool(np.allclose(paid, expected, rtol=1e-5, atol=1e-5))


@pytest.mark.parametrize("number", WORLDS)
def test_terms_sum_to_the_reward_and_masked_ones_vanish(number: int) -> None:
    task, flights, told = flown(number)
    assert sums_to(flights.terms, told)
    assert masked_vanish(flights.terms, task)
    assert paid_by_fate(task, flights)
    assert flights.terms.shape[-1] == task.scenario.launch.missiles + 2


def test_these_worlds_differ() -> None:
    tasks, flights, _ = zip(*(flown(number) for number in WORLDS), strict=True)
    assert {task.scenario.launch.missiles for task in tasks} == set(range(1, 9))
    assert len({(task.scenario.launch.missiles, task.masked) for task in tasks}) > 25
    for fate in (Fate.EVADED, Fate.HIT):
        assert sum((flight.fates[-1] == fate).sum() for flight in flights) > 50


def test_a_term_too_much_would_be_noticed() -> None:
    # The negative controls: an amount that only the sum knows, or only a term; a masked missile that pays.
    task, flights, told = next(flown(number) for number in WORLDS if flown(number)[0].masked)
    masked = min(task.masked)
    wrong = dataclasses.replace(flights, terms=flights.terms.copy())
    wrong.terms[3, 5, masked] = 0.01
    assert not sums_to(wrong.terms, told)
    assert not masked_vanish(wrong.terms, task)
    assert not paid_by_fate(task, wrong)
    other_mask = Task(task.scenario, frozenset({_paying(flights)}))
    assert not masked_vanish(flights.terms, other_mask)


@pytest.mark.parametrize("masked", [(4,), (3, 4), (2, 3, 4), (1, 2, 3, 4)])
@pytest.mark.parametrize("name", SCENARIOS)
def test_until_a_masked_missile_appears_both_tasks_pay_alike(name: str, masked: tuple[int, ...]) -> None:
    """Eq. (10) and (12): the target's reward less its masked terms is the source's, while the condition holds."""
    assert _alike(Task(SCENARIOS[name]), Task(SCENARIOS[name], frozenset(masked)), masked) > 500


def test_a_source_task_that_pays_otherwise_would_be_noticed() -> None:
    dearer = changed(SCENARIOS["drill"], reward={"evaded": 50.5})
    with pytest.raises(AssertionError):
        _alike(Task(SCENARIOS["drill"]), Task(dearer, frozenset({4})), (4,))


def _paying(flights: Flights) -> int:
    """A missile for which something is paid."""
    return int(np.flatnonzero(flights.terms[..., GOAL + 1 : -1].any(axis=(0, 1)))[0]) + 1


def _alike(target: Task, source: Task, masked: tuple[int, ...]) -> int:
    """Compare both tasks' rewards from the same initial states by the same turns; returns how many steps counted."""
    full = fly_lanes(World(target, 64, seed=9), drag, steps=200)
    world, counted = World(source, 64, seed=9), 0
    still = np.ones(64, dtype=bool)
    for k, terms in enumerate(full.terms):
        turns = drag(full.observation[k])
        still &= is_default(keep_masked(full.observation[k + 1], target.layout, source.layout))
        still &= (full.fates[k + 1][:, np.array(masked) - 1] == Fate.UNLAUNCHED).all(axis=1)
        told = world.step(turns).reward
        np.testing.assert_allclose(source_reward(terms, masked)[still], told[still], rtol=1e-6, atol=1e-6)
        assert not masked_reward(terms, masked)[still].any()
        counted += int((still & (full.steps > k)).sum())
    return counted
