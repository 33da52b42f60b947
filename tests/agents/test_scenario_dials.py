"""What a search may choose: every setting of the dials is a legal scenario with plain numbers."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from agents.scenario_dials import DEPTH, DIALS, WIDTH_SHARE, Dial, check_base, drawn, refined, with_settings
from sim.errors import ScenarioError
from sim.scenario import Scenario
from sim.scenario_file import SECTIONS, load_scenario
from tests.engagements import changed

DEFAULT = load_scenario()
SEEDS = range(50)
DIRECT = [dial for dial in DIALS if dial.name not in (DEPTH, WIDTH_SHARE)]


def on_grid(value: float, step: float) -> bool:
    """Whether a value is a multiple of a step, up to rounding."""
    return abs(value / step - round(value / step)) < 1e-6


def chosen(seed: int) -> Scenario:
    """A scenario drawn anywhere."""
    return with_settings(DEFAULT, drawn(np.random.default_rng(seed)), "drawn", "")


@pytest.mark.parametrize("dial", DIRECT, ids=lambda dial: dial.name)
def test_a_dial_lies_within_what_scenarios_allow_and_holds_its_bounds(dial: Dial) -> None:
    section, _, key = dial.name.partition(".")
    (field,) = (field for field in dataclasses.fields(SECTIONS[section]) if field.name == key)
    assert field.metadata["low"] <= dial.low < dial.high <= field.metadata["high"]


@pytest.mark.parametrize("dial", DIALS, ids=lambda dial: dial.name)
def test_bounds_lie_on_the_grid_and_the_default_scenario_within_them(dial: Dial) -> None:
    section, _, key = dial.name.partition(".")
    assert on_grid(dial.low, dial.step)
    assert on_grid(dial.high, dial.step)
    if dial in DIRECT:
        assert dial.low <= getattr(getattr(DEFAULT, section), key) <= dial.high


@pytest.mark.parametrize("seed", SEEDS)
def test_every_proposal_lies_on_the_grid_within_its_bounds(seed: int) -> None:
    draws = np.random.default_rng(seed)
    first = drawn(draws)
    for settings in (first, refined(draws, first)):
        for dial in DIALS:
            assert dial.low <= settings[dial.name] <= dial.high
            assert on_grid(settings[dial.name], dial.step)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_no_dial_stays_as_it_was(seed: int) -> None:
    scenario, names = chosen(seed), {dial.name for dial in DIRECT}
    starts = {
        field.name for field in dataclasses.fields(scenario.start) if "_x_" in field.name or "y_spread" in field.name
    }
    for section in SECTIONS:
        for field in dataclasses.fields(SECTIONS[section]):
            now, before = (getattr(getattr(one, section), field.name) for one in (scenario, DEFAULT))
            if f"{section}.{field.name}" not in names and field.name not in starts:
                assert now == before


def test_aircraft_start_in_strips_along_opposite_edges() -> None:
    settings = {dial.name: dial.low for dial in DIALS} | {"battlefield.length_m": 220e3, DEPTH: 13e3, WIDTH_SHARE: 0.85}
    start = with_settings(DEFAULT, settings | {"battlefield.width_m": 76e3}, "x", "").start
    assert (start.evader_x_low_m, start.evader_x_high_m) == (-108e3, -95e3)
    assert (start.interceptor_x_low_m, start.interceptor_x_high_m) == (95e3, 108e3)
    assert start.y_spread_m == 32.5e3  # 0.85 of 38 km is 32.3 km, on a grid of 500 m


def test_refinement_moves_some_dials_a_little() -> None:
    draws = np.random.default_rng(4)
    before = drawn(draws)
    after = [refined(draws, before) for _ in range(200)]
    moved = np.array([[one[d.name] != before[d.name] for d in DIALS] for one in after])
    assert 0.3 < moved.mean() < 0.6
    far = np.array([[abs(one[d.name] - before[d.name]) / (d.high - d.low) for d in DIALS] for one in after])
    assert far[moved].mean() < 0.15


def test_a_base_without_room_for_the_dials_is_refused() -> None:
    gate = changed(DEFAULT, battlefield={"exit_half_width_m": 37.6e3})
    with pytest.raises(ScenarioError, match="proposal from 'default': the exit gate reaches beyond the right edge"):
        check_base(gate)
    check_base(DEFAULT)


def test_the_manual_lists_every_dial_with_its_range() -> None:
    manual = (Path(__file__).parents[2] / "docs/calibration.md").read_text(encoding="utf-8")
    for dial in DIALS:
        assert f"| `{dial.name}` | {dial.low:g} | {dial.high:g} | {dial.why} |" in manual
