"""Law: aircraft and missiles stay within what their numbers allow: load factor, bank, roll rate, thrust, pull."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.scenario import Aircraft, Missile, Scenario
from tests.engagements import DRILL, FIGHTER, Policy, changed, circle, drag, task
from tests.laws.records import SCENARIOS, hard_turns
from tests.laws.tracks import (
    DT,
    GRAVITY,
    Body,
    Flight,
    body,
    density,
    fly_tracks,
    load_factor,
    missiles,
    pull,
    zigzag,
)

LANES = 24
FLIGHTS: dict[str, Policy | NDArray] = {
    "zigzag": zigzag, "drag": drag, "circle": circle, "hard": hard_turns(100, LANES, seed=3),
}  # fmt: skip
# Missiles so weak that they must always pull all they can, fired near by and at any angle.
WEAK = {"load_factor_max": 4.0, "full_load_pressure_pa": 100e3, "lag_s": 0.6, "fuse_m": 0.5}
NEAR_BY = {
    "launch": {"range_m": 20e3, "interval_s": 5.0, "range_min_m": 500.0, "radar_half_angle_rad": 1.4},
    "start": {"heading_spread_rad": 1.5, "evader_x_high_m": 10e3},
}
ROUNDING = 1e-3
"""Share of a limit: float32 headings resolve 2e-7 rad, over a substep and at 280 m/s about 1e-4 of a load factor."""


def flown(act: Policy | NDArray, scenario: Scenario = DRILL) -> NDArray:
    """Rows of 24 engagements over 100 seconds."""
    return fly_tracks(task(scenario=scenario), act, 100, LANES)


def load_used(b: Body, model: Aircraft) -> float:
    """Largest load factor over what the structure and the wing allow."""
    height, speed = b.position[:, :-1, 2], b.speed[:, :-1]
    lift = 0.5 * density(height) * speed**2 * model.wing_area_m2 * model.cl_max
    allowed = np.minimum(model.load_factor_max, lift / (model.mass_kg * GRAVITY))
    return float(np.nanmax(load_factor(b) / allowed))


def roll_used(b: Body, model: Aircraft) -> float:
    """Largest roll rate over the largest allowed."""
    return float(np.nanmax(np.abs(np.diff(b.bank))) / DT / model.roll_rate_max_rad_s)


def pull_used(m: Flight, model: Missile) -> float:
    """Largest pull over what the air allows now and the lag of the autopilot can have built up so far."""
    _, across = pull(m)
    pressure = 0.5 * density(m.position[:-1, 2]) * (m.velocity[:-1] ** 2).sum(axis=1)
    allowed = model.load_factor_max * GRAVITY * np.minimum(1.0, pressure / model.full_load_pressure_pa)
    reached, most = 0.0, np.empty_like(allowed)
    for n, limit in enumerate(allowed):
        reached = min(limit, reached + (limit - reached) * -np.expm1(-DT / model.lag_s))
        most[n] = reached
    # Two hundredths of m/s^2: float32 speeds of a thousand metres per second, over a substep.
    return float(((across - 0.02) / most).max())


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("flight", FLIGHTS)
def test_the_load_factor_stays_within_structure_and_lift(flight: str, side: int) -> None:
    used = load_used(body(flown(FLIGHTS[flight]), side), FIGHTER)
    assert used < 1.0 + ROUNDING
    # The evader does go to the limit, or nothing would have been tested.
    assert side == 1 or used > 0.99


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("flight", FLIGHTS)
def test_it_rolls_no_faster_than_allowed_and_never_over(flight: str, side: int) -> None:
    b = body(flown(FLIGHTS[flight]), side)
    used = roll_used(b, FIGHTER)
    assert used < 1.0 + ROUNDING
    assert side == 1 or used > 0.99
    # A coordinated turn of at most the structure's load factor needs no more bank than this.
    assert np.nanmax(np.abs(b.bank)) <= np.arccos(0.2 / FIGHTER.load_factor_max) + 1e-6


def weak_pulls(**other: float) -> list[float]:
    """What weak missiles use of their limits, when some of their numbers are other than the limits say."""
    scenario = changed(missile=WEAK | other, **NEAR_BY)
    allowed = changed(missile=WEAK).missile
    return [pull_used(m, allowed) for m in missiles(flown(FLIGHTS["hard"], scenario))]


@pytest.mark.parametrize("flight", FLIGHTS)
def test_missiles_pull_no_more_than_structure_and_air_allow(flight: str) -> None:
    used = [pull_used(m, DRILL.missile) for m in missiles(flown(FLIGHTS[flight]))]
    assert len(used) > 30
    assert max(used) < 1.0 + ROUNDING


def test_weak_missiles_pull_all_they_may_and_no_more() -> None:
    assert 0.99 < max(weak_pulls()) < 1.0 + ROUNDING


def test_the_default_scenario_keeps_its_limits_too() -> None:
    scenario = SCENARIOS["default"]
    rows = flown(FLIGHTS["hard"], scenario)
    for b, model in ((body(rows, 0), scenario.evader), (body(rows, 1), scenario.interceptor)):
        assert load_used(b, model) < 1.0 + ROUNDING
        assert roll_used(b, model) < 1.0 + ROUNDING
    assert max(pull_used(m, scenario.missile) for m in missiles(rows)) < 1.0 + ROUNDING


@pytest.mark.parametrize("name", ["load_factor_max", "cl_max", "roll_rate_max_rad_s"])
def test_an_aircraft_allowed_a_hundredth_more_would_be_noticed(name: str) -> None:
    bolder = changed(evader={name: getattr(FIGHTER, name) * 1.01})
    b = body(flown(FLIGHTS["hard"], bolder), side=0)
    assert max(load_used(b, FIGHTER), roll_used(b, FIGHTER)) > 1.0 + ROUNDING


@pytest.mark.parametrize(
    ("name", "factor"), [("load_factor_max", 1.01), ("full_load_pressure_pa", 0.99), ("lag_s", 0.9)]
)
def test_a_missile_allowed_a_little_more_would_be_noticed(name: str, factor: float) -> None:
    assert max(weak_pulls(**{name: WEAK[name] * factor})) > 1.0 + ROUNDING


def test_a_turn_bends_the_way_it_banks() -> None:
    b = body(flown(zigzag), side=0)
    turning = np.abs(b.bank[:, 1:]) > 0.1
    bent = np.diff(b.heading)
    bent = np.arctan2(np.sin(bent), np.cos(bent))
    assert (np.sign(bent[turning]) == np.sign(b.bank[:, 1:][turning])).all()


def test_thrust_never_exceeds_the_engine() -> None:
    b = body(fly_tracks(task(1, 2, 3, 4), zigzag, 60, LANES), side=0)
    height, speed, load = b.position[..., 2], b.speed, load_factor(b)
    energy_rate = FIGHTER.mass_kg * np.diff(speed**2 / 2 + GRAVITY * height) / DT
    air = density(height[:, :-1])
    pressure = 0.5 * air * speed[:, :-1] ** 2 * FIGHTER.wing_area_m2
    drag_n = pressure * FIGHTER.cd0 + FIGHTER.induced_drag * (load * FIGHTER.mass_kg * GRAVITY) ** 2 / pressure
    thrust_n = energy_rate / speed[:, :-1] + drag_n
    # Averages over a second: single differences of float32 heights are noisy.
    over = _each_second(thrust_n - FIGHTER.thrust_max_n * (air / 1.225) ** 0.7)
    assert -1e3 < np.nanmax(over) < 0.01 * FIGHTER.thrust_max_n
    assert np.nanmin(_each_second(thrust_n)) > -0.01 * FIGHTER.thrust_max_n


def _each_second(rows: NDArray) -> NDArray:
    return rows[:, : rows.shape[1] // 20 * 20].reshape(len(rows), -1, 20).mean(axis=2)
