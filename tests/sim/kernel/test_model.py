"""Every number of a scenario reaches the kernel, under its name without the unit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.device import start_warp
from sim.kernel.model import kernel_model, kernel_state
from sim.scenario_file import SECTIONS
from sim.world import World
from tests.engagements import DRILL, MASKS, changed, circle, drag, fly_lanes, task, to_exit

NUMBERS = [
    (section, field.name)
    for section in ("evader", "interceptor", "missile")
    for field in dataclasses.fields(SECTIONS[section])
]
UNITS = ("_kg", "_m2", "_n", "_s", "_m", "_pa", "_m_s", "_rad_s", "_1_s")


@pytest.mark.parametrize(("section", "name"), NUMBERS)
def test_every_number_of_a_body_arrives(section: str, name: str) -> None:
    value = getattr(getattr(DRILL, section), name) * 1.25
    part = getattr(kernel_model(changed(**{section: {name: value}})), section)
    plain = max((name.removesuffix(unit) for unit in UNITS if hasattr(part, name.removesuffix(unit))), key=len)
    assert getattr(part, plain) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("battlefield", "length_m", 30e3),
        ("battlefield", "width_m", 33e3),
        ("battlefield", "exit_half_width_m", 900.0),
        ("battlefield", "exit_y_m", 15e3),
        ("launch", "radar_range_m", 9e3),
        ("launch", "radar_half_angle_rad", 0.06),
        ("launch", "range_m", 9e3),
        ("launch", "tail_fraction", 0.1),
        ("launch", "range_min_m", 29e3),
        ("launch", "interval_s", 90.0),
        ("rules", "substeps", 5),
        ("rules", "max_steps", 20),
        ("rules", "outside_steps", 30),
        ("rules", "step_s", 0.5),
        ("reward", "exit", 7.0),
        ("reward", "evaded", 7.0),
        ("reward", "shot_down", -7.0),
        ("reward", "step", -7.0),
    ],
)
def test_every_other_number_changes_flights(section: str, key: str, value: float) -> None:
    # Missiles fly from the start, so that the radar's half angle matters before the interceptor has turned.
    base = changed(launch={"range_m": 60e3}, missile={"age_max_s": 30.0})
    plain, other = (
        fly_lanes(World(task(4, scenario=scenario), 96, seed=1), mixed, steps=300)
        for scenario in (base, changed(base, **{section: {key: value}}))
    )
    same = np.array_equal(plain.observation, other.observation) and np.array_equal(plain.terms, other.terms)
    assert not same


def mixed(observation: np.ndarray) -> np.ndarray:
    """Lanes that drag, circle, head for the exit or straight on: every rule is met by somebody."""
    turns = drag(observation)
    turns[::4] = circle(observation[::4])
    turns[1::4] = to_exit(observation[1::4])
    turns[2::4] = 0.0
    return turns


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_masked_missiles_are_not_available(masked: frozenset[int]) -> None:
    start_warp()
    available = kernel_state(task(*masked), 1, "cpu").available.numpy()
    assert [bool(a) for a in available] == [m not in masked for m in (1, 2, 3, 4)]


def test_the_state_has_one_row_per_group_of_lanes() -> None:
    start_warp()
    state = kernel_state(task(), 5, "cpu")
    assert state.aircraft.shape == (5, 2)
    assert state.fate.shape == state.missile.shape == (5, 4)
    assert state.steps.shape == (5,)
