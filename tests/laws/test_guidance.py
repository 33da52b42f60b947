"""Proportional navigation does what it is known for."""

from __future__ import annotations

import numpy as np
import pytest

from sim.trajectory import fly
from sim.world import Fate
from tests.engagements import changed, straight, task

# Within 15 km, where the motor has energy to spare, and with a fuse too small to end the pass early.
ENVELOPE = {
    "launch": {"range_m": 15e3, "spread": 0.0, "tail_fraction": 1.0},
    "missile": {"fuse_m": 0.5, "arm_s": 0.0},
}


@pytest.mark.parametrize("heading_spread_rad", [0.0, 0.6, 1.2])
@pytest.mark.parametrize("lag_s", [0.05, 0.6])
def test_a_straight_target_inside_the_envelope_is_met_within_a_metre(heading_spread_rad: float, lag_s: float) -> None:
    scenario = changed(
        changed(**ENVELOPE),
        start={"heading_spread_rad": heading_spread_rad, "y_spread_m": 8e3},
        missile={"lag_s": lag_s},
    )
    launched = 0
    for episode in range(12):
        missile = fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=17, episode=episode).missiles[0]
        if missile.fate in (Fate.UNLAUNCHED, Fate.FLYING):
            continue  # never in the zone, or gone from the battlefield before the missile came
        launched += 1
        assert missile.closest_m < 1.0
    assert launched >= 6


def test_on_its_way_the_line_of_sight_stops_turning() -> None:
    missile = fly(task(2, 3, 4, scenario=changed(**ENVELOPE)), straight, "test", seed=17).missiles[0]
    flying = np.flatnonzero(np.isfinite(missile.range_m))
    # From the evader's nose, which does not turn, the missile stands still: the constant-bearing approach.
    late = flying[len(flying) // 2 : -20]
    assert np.ptp(missile.azimuth_rad[late]) < 0.02


def test_a_weaker_navigation_constant_misses_by_more() -> None:
    # The negative control: with N = 1 the missile chases the target's tail instead of leading it.
    crossing = {"start": {"heading_spread_rad": 1.2, "y_spread_m": 8e3}}
    miss = {}
    for constant in (1.0, 4.0):
        scenario = changed(changed(**ENVELOPE, **crossing), missile={"navigation_constant": constant})
        flown = [fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=17, episode=e) for e in range(12)]
        ended = [t.missiles[0] for t in flown if t.missiles[0].fate in (Fate.EVADED, Fate.HIT)]
        miss[constant] = max(missile.closest_m for missile in ended)
    assert miss[4.0] < 1.0
    assert miss[1.0] > 10.0


def test_a_shot_on_the_level_stays_on_the_level() -> None:
    # Gravity is compensated; what remains is the lag of the autopilot at launch. Without it the missile sags 250 m.
    scenario = changed(changed(**ENVELOPE), start={"altitude_spread_m": 0.0})
    height = fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=17).missiles[0].position_m[:, 2]
    assert np.nanmax(height) - np.nanmin(height) < 60.0
