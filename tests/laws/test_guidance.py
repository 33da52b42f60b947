"""Law: proportional navigation closes to less than a metre on a straight target inside its envelope."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.trajectory import fly
from sim.world import Fate
from tests.engagements import DRILL, changed, straight, task
from tests.laws.tracks import fly_tracks

# Within 15 km, where the motor has energy to spare, and with a fuse too small to end the pass early.
ENVELOPE = changed(launch={"range_m": 15e3, "spread": 0.0, "tail_fraction": 1.0}, missile={"fuse_m": 0.5, "arm_s": 0.0})
DEFAULT_MISSILE = dataclasses.replace(load_scenario().missile, fuse_m=0.5, arm_s=0.0)
GEOMETRIES = {
    "head-on": {"heading_spread_rad": 0.0},
    "oblique": {"heading_spread_rad": 0.6, "y_spread_m": 8e3},
    "crossing": {"heading_spread_rad": 1.2, "y_spread_m": 8e3},
    "high and low": {"heading_spread_rad": 0.6, "altitude_spread_m": 2e3},
}
WITHIN_M = 1.0


def misses(scenario: Scenario) -> NDArray:
    """Closest approaches [m] of missile 1 to a target that flies straight, of those that came to their end."""
    rows = fly_tracks(task(2, 3, 4, scenario=scenario), straight, 150, lanes=24, seed=17)
    fates, closest = np.nanmax(rows[..., 20], axis=1), np.where(np.isfinite(rows[..., 21]), rows[..., 21], np.inf)
    return closest.min(axis=1)[fates >= Fate.EVADED]


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("lag_s", [0.05, 0.6])
def test_a_straight_target_is_met_within_a_metre(geometry: str, lag_s: float) -> None:
    found = misses(changed(ENVELOPE, start=GEOMETRIES[geometry], missile={"lag_s": lag_s}))
    assert len(found) >= 10
    assert found.max() < WITHIN_M


@pytest.mark.parametrize("geometry", ["head-on", "oblique", "high and low"])
def test_the_default_scenarios_missile_meets_it_too(geometry: str) -> None:
    scenario = dataclasses.replace(changed(ENVELOPE, start=GEOMETRIES[geometry]), missile=DEFAULT_MISSILE)
    found = misses(scenario)
    assert len(found) >= 10
    assert found.max() < WITHIN_M


@pytest.mark.parametrize(
    "flaw", [{"navigation_constant": 1.0}, {"lag_s": 5.0}, {"load_factor_max": 3.0}], ids=["N = 1", "slow", "weak"]
)
def test_worse_missiles_would_be_noticed(flaw: dict[str, float]) -> None:
    # The negative controls: chasing the tail instead of leading it; an autopilot too slow, a pull too small for a pass.
    assert misses(changed(ENVELOPE, start=GEOMETRIES["crossing"], missile=flaw)).max() > 10.0 * WITHIN_M


def test_on_its_way_the_line_of_sight_stops_turning() -> None:
    missile = fly(task(2, 3, 4, scenario=ENVELOPE), straight, "test", seed=17).missiles[0]
    flying = np.flatnonzero(np.isfinite(missile.range_m))
    # From the evader's nose, which does not turn, the missile stands still: the constant-bearing approach.
    late = flying[len(flying) // 2 : -20]
    assert np.ptp(missile.azimuth_rad[late]) < 0.02


def test_a_shot_on_the_level_stays_on_the_level() -> None:
    # Gravity is compensated; what remains is the lag of the autopilot at launch. Without it the missile sags 250 m.
    scenario = changed(ENVELOPE, start={"altitude_spread_m": 0.0})
    height = fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=17).missiles[0].position_m[:, 2]
    assert np.nanmax(height) - np.nanmin(height) < 60.0
    assert DRILL.missile.lag_s == 0.6
