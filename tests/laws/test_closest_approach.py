"""Law: halving the substep moves no pass that the fuse could see by a tenth of a metre, and decides no kill."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.trajectory import fly
from sim.world import Fate, Outcome, World
from tests.engagements import Policy, changed, fly_lanes, straight, task, to_exit
from tests.laws.tracks import fly_tracks

NEAR = {"interceptor_x_low_m": -18e3, "interceptor_x_high_m": -10e3, "y_spread_m": 6e3}
WITHIN_M = 0.1
GEOMETRIES = {
    "head-on": NEAR,
    "crossing": NEAR | {"heading_spread_rad": 1.2},
    "high and low": NEAR | {"altitude_spread_m": 3e3},
}


def passes(substeps: int, act: Policy, **start: float) -> tuple[NDArray, NDArray]:
    """Closest approach by the kernel's closed form and by its records [m] of the passes below 50 m, lane by lane.

    The first missile alone, in the zone from the start and never armed; NaN for other lanes.
    """
    scenario = changed(start=start, rules={"substeps": substeps}, missile={"arm_s": 30.0}, launch={"range_m": 60e3})
    rows = fly_tracks(task(2, 3, 4, scenario=scenario), act, 100, lanes=24, seed=31)
    exact = np.where(np.isfinite(rows[..., 21]), rows[..., 21], np.inf).min(axis=1)
    apart = np.linalg.norm(rows[..., :3] - rows[..., 14:17], axis=2)
    sampled = np.nanmin(np.where(rows[..., 20] == Fate.FLYING, apart, np.nan), axis=1)
    return np.where(exact < 50.0, exact, np.nan), np.where(exact < 50.0, sampled, np.nan)


def largest_shift(coarse: NDArray, fine: NDArray) -> float:
    """By how much halving the substep moves the closest approach at most [m]."""
    assert np.isfinite(coarse).sum() >= 10
    np.testing.assert_array_equal(np.isfinite(coarse), np.isfinite(fine))
    return float(np.nanmax(np.abs(coarse - fine)))


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_halving_the_substep_moves_a_pass_by_less_than_a_tenth_of_a_metre(geometry: str) -> None:
    coarse, fine = (passes(n, straight, **GEOMETRIES[geometry])[0] for n in (20, 40))
    assert largest_shift(coarse, fine) < WITHIN_M


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_distances_sampled_at_substeps_would_not_do(geometry: str) -> None:
    # The negative control: the same check on the distances at the substeps' ends.
    coarse, fine = (passes(n, straight, **GEOMETRIES[geometry])[1] for n in (20, 40))
    assert largest_shift(coarse, fine) > 5.0


def test_a_substep_of_half_a_second_would_not_do() -> None:
    # Another: the closed form is not all, guidance must be asked often enough.
    coarse, fine = (passes(n, straight, **GEOMETRIES["crossing"])[0] for n in (2, 4))
    assert largest_shift(coarse, fine) > WITHIN_M


@pytest.mark.parametrize("substeps", [10, 40])
def test_who_is_shot_down_does_not_depend_on_the_substep(substeps: int) -> None:
    twenty = fly_lanes(World(task(2, 3, 4), 64, seed=4), to_exit)
    others = fly_lanes(World(task(2, 3, 4, scenario=changed(rules={"substeps": substeps})), 64, seed=4), to_exit)
    assert (twenty.outcome == others.outcome).mean() > 0.98
    assert (twenty.outcome == Outcome.SHOT_DOWN).any()


def test_a_missile_that_falls_short_falls_short_by_the_same_within_three_percent() -> None:
    # What halving does change is the instant of launch (by a substep) and the integration of a long flight.
    shifts = []
    for episode in range(8):
        pair = []
        for substeps in (20, 40):
            scenario = changed(rules={"substeps": substeps}, missile={"cd0": 1.5})
            pair.append(fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=8, episode=episode).missiles[0])
        if pair[0].fate is pair[1].fate is Fate.EVADED:
            shifts.append(abs(pair[0].closest_m - pair[1].closest_m) / pair[1].closest_m)
    assert len(shifts) >= 4
    assert max(shifts) < 0.03


@pytest.mark.parametrize("burn_s", [8.0, 8.02, 7.77])
def test_the_motors_impulse_does_not_depend_on_the_substep(burn_s: float) -> None:
    # Whole substeps of thrust would round the burn up: at 20 substeps 8.02 s would burn 8.05 s.
    speeds = []
    for substeps in (20, 40, 80):
        scenario = changed(rules={"substeps": substeps}, missile={"burn_s": burn_s, "fuse_m": 0.5})
        missile = fly(task(2, 3, 4, scenario=scenario), straight, "test", seed=8).missiles[0]
        speeds.append(np.nanmax(missile.speed_m_s))
    # One extra substep of 0.05 s would be worth 10 kN / 110 kg x 0.05 s = 4.5 m/s.
    assert np.ptp(speeds) < 1.0
