"""Law: the work of thrust and drag is the change of energy, within half a per cent, for aircraft and for missiles.

The ledger knows the recorded path and the scenario's numbers, nothing of the kernel: load factor and pull from the
path's curvature, drag and thrust from the model's equations, air from the hydrostatic equation.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.scenario import Aircraft, Missile, Scenario
from sim.start import initial_states
from tests.engagements import DRILL, Policy, changed, circle, drag, straight, task
from tests.laws.records import SCENARIOS, hard_turns
from tests.laws.tracks import (
    DRAG_SHARE,
    DT,
    GRAVITY,
    MACH,
    Body,
    Flight,
    body,
    density,
    fly_tracks,
    load_factor,
    missiles,
    pull,
    sound,
    zigzag,
)

WITHIN = 0.005
"""Of the larger of the two works."""
LANES = 24
FLIGHTS: dict[str, Policy | NDArray] = {
    "straight": straight, "circle": circle, "zigzag": zigzag, "hard": hard_turns(60, LANES, seed=3),
}  # fmt: skip
GLIDER = changed(evader={"thrust_max_n": 0.0}, interceptor={"thrust_max_n": 0.0})


def aircraft_imbalance(b: Body, model: Aircraft, held_m_s: NDArray) -> NDArray:
    """Energy `[L]` that appears from nowhere or goes there, over the larger work; the engine holds a speed `[L]`."""
    speed, height = b.speed[:, :-1], b.position[:, :-1, 2]
    air, weight = density(height), model.mass_kg * GRAVITY
    pressure_area = 0.5 * air * speed**2 * model.wing_area_m2
    drag_n = pressure_area * model.cd0 + model.induced_drag * (load_factor(b) * weight) ** 2 / pressure_area
    wanted_n = drag_n + 0.2 * model.mass_kg * (held_m_s[:, None] - speed)
    thrust_n = np.clip(wanted_n, 0.0, model.thrust_max_n * (air / 1.225) ** 0.7)
    metres = DT * (b.speed[:, 1:] + speed) / 2
    gained = np.diff(b.speed**2 / 2 + GRAVITY * b.position[..., 2], axis=1)
    thrust, lost, gained = (
        np.nansum(each, axis=1) for each in (thrust_n * metres, drag_n * metres, model.mass_kg * gained)
    )
    return np.abs(thrust - lost - gained) / np.maximum(thrust, lost)


def missile_works(m: Flight, model: Missile) -> tuple[NDArray, NDArray, NDArray]:
    """Work of thrust, work of drag and change of energy in every substep `[n]` [J/kg]."""
    nose, across = pull(m)
    speed, height = np.linalg.norm(m.velocity, axis=1), m.position[:-1, 2]
    pressure = 0.5 * density(height) * speed[:-1] ** 2
    mass = model.mass_kg - model.propellant_kg * np.clip(m.age / model.burn_s, 0.0, 1.0)
    thrust_n = model.thrust_n * np.clip((model.burn_s - m.age) / DT, 0.0, 1.0)
    drag_n = pressure * model.area_m2 * model.cd0 * np.interp(speed[:-1] / sound(height), MACH, DRAG_SHARE)
    drag_n += model.induced_drag * (mass * across) ** 2 / (pressure * model.area_m2)
    metres = DT * ((m.velocity[1:] + m.velocity[:-1]) / 2 * nose).sum(axis=1)
    gained = np.diff(speed**2 / 2 + GRAVITY * m.position[:, 2])
    return thrust_n / mass * metres, drag_n / mass * metres, gained


def missile_imbalances(act: Policy | NDArray, scenario: Scenario, model: Missile) -> NDArray:
    """The same for every missile that a scenario's engagements fire, over its whole flight."""
    found = missiles(fly_tracks(task(scenario=scenario), act, 120, LANES))
    sums = [[each.sum() for each in missile_works(missile, model)] for missile in found]
    return np.array([abs(thrust - lost - gained) / max(thrust, lost) for thrust, lost, gained in sums])


def aircraft_imbalances(act: Policy | NDArray, scenario: Scenario, model: Aircraft, side: int) -> NDArray:
    """The same for an aircraft of a scenario without missiles."""
    rows = fly_tracks(task(1, 2, 3, 4, scenario=scenario), act, 60, LANES)
    start = initial_states(scenario, 3, np.arange(LANES)).astype(float)
    return aircraft_imbalance(body(rows, side), model, held_m_s=start[:, 4 + 5 * side])


@pytest.mark.parametrize("side", [0, 1])
@pytest.mark.parametrize("scenario", [DRILL, GLIDER], ids=["powered", "glider"])
@pytest.mark.parametrize("flight", FLIGHTS)
def test_aircraft_balance(flight: str, scenario: Scenario, side: int) -> None:
    imbalance = aircraft_imbalances(FLIGHTS[flight], scenario, scenario.evader, side)
    assert len(imbalance) == LANES
    assert imbalance.max() < WITHIN


@pytest.mark.parametrize(
    ("name", "factor"), [("cd0", 1.1), ("induced_drag", 1.02), ("thrust_max_n", 1.01), ("mass_kg", 1.01)]
)
def test_an_aircraft_that_flies_by_other_numbers_than_the_ledgers_would_be_noticed(name: str, factor: float) -> None:
    other = changed(evader={name: getattr(DRILL.evader, name) * factor})
    assert aircraft_imbalances(circle, other, DRILL.evader, side=0).max() > WITHIN


@pytest.mark.parametrize(
    "act", [straight, drag, zigzag, hard_turns(120, LANES, seed=3)], ids=["straight", "drag", "zigzag", "hard"]
)
def test_missiles_balance(act: Policy | NDArray) -> None:
    imbalance = missile_imbalances(act, DRILL, DRILL.missile)
    assert len(imbalance) > 40
    assert imbalance.max() < WITHIN


def test_missiles_of_the_default_scenario_balance() -> None:
    default = SCENARIOS["default"]
    imbalance = missile_imbalances(hard_turns(120, LANES, seed=3), default, default.missile)
    assert len(imbalance) > 20
    assert imbalance.max() < WITHIN


@pytest.mark.parametrize(
    ("name", "factor"), [("cd0", 1.01), ("induced_drag", 1.05), ("thrust_n", 1.01), ("propellant_kg", 1.05)]
)
def test_a_missile_that_flies_by_other_numbers_than_the_ledgers_would_be_noticed(name: str, factor: float) -> None:
    other = changed(missile={name: getattr(DRILL.missile, name) * factor})
    assert missile_imbalances(drag, other, DRILL.missile).max() > WITHIN


def never_gains(scenario: Scenario, model: Missile) -> bool:
    """Whether no missile ever has more energy than it had when fired and its motor has given since.

    Fired at targets close by and far above, missiles are asked at once for more than slow air can give.
    """
    draw = np.random.default_rng(0)
    near = changed(scenario, launch={"range_m": 40e3, "spread": 0.0})
    states = initial_states(near, 3, np.arange(64))
    states[:, :5] = np.array([0.0, 0.0, 11e3, 0.0, 280.0])
    states[:, 2] += draw.uniform(-2e3, 2e3, 64)
    states[:, 5:10] = np.array([6.5e3, 0.0, 7e3, np.pi, 290.0])
    states[:, 5:7] += draw.uniform(-2.5e3, 2.5e3, (64, 2))
    found = missiles(fly_tracks(task(2, 3, 4, scenario=near), straight, 40, 64, states=states))
    assert len(found) > 20
    works = [missile_works(missile, model) for missile in found]
    return all((gained.cumsum() < thrust.cumsum() * (1 + WITHIN)).all() for thrust, _, gained in works)


def test_no_missile_gains_more_energy_than_its_motor_gives() -> None:
    assert never_gains(DRILL, DRILL.missile)


def test_a_motor_that_gives_more_than_the_ledger_knows_would_be_noticed() -> None:
    assert not never_gains(changed(missile={"thrust_n": DRILL.missile.thrust_n * 1.25}), DRILL.missile)
