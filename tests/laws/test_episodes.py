"""Law: how episodes end, what that earns, and that they stay ended."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from sim.scenario import Scenario
from sim.scenario_file import load_scenario, scenario_names
from sim.trajectory import fly
from sim.world import Fate, Outcome, World
from tests.engagements import Flights, changed, circle, drag, fly_lanes, task

# Missiles that give up after five seconds: whoever stays away from the interceptor evades all four.
HARMLESS = changed(missile={"age_max_s": 5.0, "fuse_m": 0.5}, rules={"max_steps": 1200})
MIXED = 64


@pytest.fixture(scope="module")
def flights() -> Flights:
    """Flights that end in different ways and at different times."""
    return fly_lanes(World(task(), MIXED, seed=1), drag)


def loitering_earns_80(scenario: Scenario) -> bool:
    """Whether everyone who evades all four and loiters to the end has a return of 80."""
    lanes = fly_lanes(World(task(scenario=scenario), 16, seed=3), circle)
    loitered = (lanes.outcome == Outcome.TIMEOUT) & (lanes.fates[-1] == Fate.EVADED).all(axis=1)
    assert loitered.sum() >= 12
    return bool(np.allclose(lanes.terms[:, loitered].sum(axis=(0, 2), dtype=np.float64), 80.0, rtol=0.0, atol=1e-4))


def test_evading_all_four_and_loitering_earns_exactly_80() -> None:
    # 4 x 50 - 1200 x 0.1: what the paper's TD3 (64.61) and SAC (77.17) come to, without ever reaching the exit.
    assert loitering_earns_80(HARMLESS)
    recorded = [fly(task(scenario=HARMLESS), circle, "loiter", seed=3, episode=e) for e in range(2)]
    returns = [flight.episode_return for flight in recorded if flight.outcome is Outcome.TIMEOUT]
    assert returns
    assert all(math.isclose(earned, 80.0, abs_tol=1e-9) for earned in returns)
    assert recorded[0].duration_s == 1200.0


@pytest.mark.parametrize("rule", [{"reward": {"step": -0.1001}}, {"rules": {"max_steps": 1199}}])
def test_a_second_less_or_a_dearer_one_would_be_noticed(rule: dict[str, dict[str, float]]) -> None:
    assert not loitering_earns_80(changed(HARMLESS, **rule))


@pytest.mark.parametrize("name", scenario_names())
def test_loitering_without_missiles_costs_a_tenth_per_second(name: str) -> None:
    scenario = load_scenario(name)
    quiet = dataclasses.replace(scenario, start=dataclasses.replace(scenario.start, y_spread_m=0.0))
    every = range(1, scenario.launch.missiles + 1)
    lanes = fly_lanes(World(task(*every, scenario=quiet), 2), circle)
    assert (lanes.outcome == Outcome.TIMEOUT).all()
    np.testing.assert_allclose(lanes.terms.sum(axis=(0, 2), dtype=np.float64), -120.0, atol=1e-4)


def test_the_time_limit_truncates_without_a_penalty() -> None:
    scenario = changed(rules={"max_steps": 50})
    lanes = fly_lanes(World(task(1, 2, 3, 4, scenario=scenario), 4), circle)
    assert (lanes.steps == 50).all()
    assert lanes.truncated[49].all()
    assert not lanes.truncated[:49].any()
    assert not lanes.terminated.any()
    np.testing.assert_array_equal(lanes.terms[49], lanes.terms[0])


def test_a_loss_in_the_last_step_is_a_loss_and_no_timeout() -> None:
    ended = fly_lanes(World(task(), 8, seed=1), circle)
    lane = int(np.flatnonzero(ended.outcome == Outcome.SHOT_DOWN)[0])
    scenario = changed(rules={"max_steps": int(ended.steps[lane])})
    again = fly_lanes(World(task(scenario=scenario), 8, seed=1), circle)
    last = ended.steps[lane] - 1
    assert again.outcome[lane] == Outcome.SHOT_DOWN
    assert (again.terminated[last, lane], again.truncated[last, lane]) == (True, False)


def test_these_flights_end_in_several_ways(flights: Flights) -> None:
    assert set(flights.outcome) == {Outcome.EXIT, Outcome.SHOT_DOWN, Outcome.LEFT_FIELD}


def test_an_episode_ends_once_and_then_stays_frozen(flights: Flights) -> None:
    for lane in range(MIXED):
        over = flights.steps[lane]
        ends = flights.terminated[:, lane] | flights.truncated[:, lane]
        np.testing.assert_array_equal(np.flatnonzero(ends), [over - 1])
        frozen = flights.observation[over:, lane]
        np.testing.assert_array_equal(frozen, np.broadcast_to(frozen[0], frozen.shape))
        assert not flights.terms[over:, lane].any()
        np.testing.assert_array_equal(flights.fates[over:, lane], flights.fates[over : over + 1, lane].repeat(
            len(flights.fates) - over, axis=0))  # fmt: skip


@pytest.mark.parametrize(
    ("outcome", "goal"), [(Outcome.EXIT, 400.0), (Outcome.LEFT_FIELD, -400.0), (Outcome.SHOT_DOWN, 0.0)]
)
def test_the_goals_term_pays_once_at_the_end(flights: Flights, outcome: Outcome, goal: float) -> None:
    lanes = np.flatnonzero(flights.outcome == outcome)
    assert len(lanes) > 0
    for lane in lanes:
        paid = flights.terms[:, lane, 0]
        assert paid[flights.steps[lane] - 1] == goal
        assert np.count_nonzero(paid) == (goal != 0.0)


def test_a_missile_pays_once_by_its_fate(flights: Flights) -> None:
    worth = {Fate.UNLAUNCHED: 0.0, Fate.FLYING: 0.0, Fate.EVADED: 50.0, Fate.HIT: -400.0}
    for lane in range(MIXED):
        for missile in range(4):
            paid = flights.terms[:, lane, 1 + missile]
            fate = Fate(flights.fates[-1, lane, missile])
            assert paid.sum() == worth[fate]
            assert np.count_nonzero(paid) == (worth[fate] != 0.0)


def test_every_step_flown_costs_a_tenth(flights: Flights) -> None:
    np.testing.assert_array_equal(np.count_nonzero(flights.terms[:, :, -1], axis=0), flights.steps)
    assert set(np.unique(flights.terms[:, :, -1])) == {np.float32(0.0), np.float32(-0.1)}


def test_exactly_one_missile_kills(flights: Flights) -> None:
    for lane in range(MIXED):
        hits = np.flatnonzero(flights.fates[-1, lane] == Fate.HIT) + 1
        expected = [flights.killer[lane]] if flights.outcome[lane] == Outcome.SHOT_DOWN else []
        assert hits.tolist() == expected
        assert (flights.killer[lane] > 0) == (flights.outcome[lane] == Outcome.SHOT_DOWN)


def test_a_missile_is_unlaunched_then_flies_then_ends(flights: Flights) -> None:
    assert (np.diff(flights.fates, axis=0) >= 0).all()
    assert not ((flights.fates[:-1] == Fate.EVADED) & (flights.fates[1:] == Fate.HIT)).any()


def test_two_missiles_that_arrive_together_kill_once() -> None:
    # A whole second per substep and a wide fuse: several missiles can be inside it at the end of the same substep.
    scenario = changed(
        missile={"fuse_m": 1000.0, "arm_s": 0.0},
        launch={"interval_s": 1.0, "range_m": 15e3, "range_min_m": 0.0},
        rules={"substeps": 1},
    )
    lanes = fly_lanes(World(task(scenario=scenario), 64, seed=1), drag)
    killed = lanes.outcome == Outcome.SHOT_DOWN
    assert killed.any()
    assert ((lanes.fates[-1, killed] == Fate.HIT).sum(axis=1) == 1).all()
    penalties = np.minimum(lanes.terms[:, killed, 1:5], 0.0).sum(axis=(0, 2))
    np.testing.assert_array_equal(penalties, np.full(killed.sum(), -400.0))


def test_return_of_a_perfect_flight_is_600_less_a_tenth_per_second() -> None:
    # The best the paper's reward allows: 400 + 4 x 50 - 0.1 per step.
    lanes = fly_lanes(World(task(scenario=HARMLESS), 64, seed=3), drag)
    perfect = (lanes.outcome == Outcome.EXIT) & (lanes.fates[-1] == Fate.EVADED).all(axis=1)
    assert perfect.any()
    returns = lanes.terms[:, perfect].sum(axis=(0, 2), dtype=np.float64)
    np.testing.assert_allclose(returns, 600.0 - 0.1 * lanes.steps[perfect], atol=1e-4)
    assert math.isclose(returns.max(), 600.0 - 0.1 * lanes.steps[perfect].min(), abs_tol=1e-4)
