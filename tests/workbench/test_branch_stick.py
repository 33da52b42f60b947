"""The stick: what is flown by hand live is what the branch flies afterwards, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

from sim.geometry import azimuth
from sim.start import initial_states
from sim.trajectory import fly
from sim.world import Outcome
from tests.engagements import DRILL, circle, drag, task
from workbench.branch import Branch, BranchError, fly_branch
from workbench.branch_stick import Stick

ORIGINAL = fly(task(3), drag, "drag", seed=5)
START = Branch("A", 40, (), "drag")
HEADINGS = (170, 170, 350, 10, 10, 10, 95, 95, 270, 180, 181, 182)


def _steered() -> Stick:
    stick = Stick(ORIGINAL, START)
    for heading in HEADINGS:
        stick.step(heading)
    return stick


def test_the_branch_afterwards_is_what_was_flown_live() -> None:
    stick = _steered()
    branch = stick.flown("circle")
    assert branch == Branch("A", 40, HEADINGS, "circle")
    flight = fly_branch(ORIGINAL, branch, circle)
    for time_s in (40.0, 40.05, 40.1, 45.35, 51.95, 52.0):
        row = round(time_s * DRILL.rules.substeps)
        pose = stick.poses(time_s)["evader"]
        np.testing.assert_array_equal(pose.position_m, flight.evader.position_m[row])
        assert pose.heading_rad == flight.evader.heading_rad[row]
        assert pose.bank_rad == flight.evader.bank_rad[row]


def test_missiles_are_posed_while_they_fly() -> None:
    stick = _steered()
    flight = fly_branch(ORIGINAL, stick.flown(), None)
    assert set(stick.poses(52.0)) >= {"evader", "interceptor"}
    flying = {f"missile_{m.number}" for m in flight.missiles if np.isfinite(m.position_m[52 * DRILL.rules.substeps, 0])}
    assert flying
    assert {name for name in stick.poses(52.0) if name.startswith("missile")} == flying
    track = next(m for m in flight.missiles if f"missile_{m.number}" in flying)
    pose = stick.poses(52.0)[f"missile_{track.number}"]
    assert pose.heading_rad == pytest.approx(track.heading_rad[52 * DRILL.rules.substeps])
    assert pose.pitch_rad == pytest.approx(track.pitch_rad[52 * DRILL.rules.substeps])


def test_a_stick_taken_up_again_is_where_it_was_left() -> None:
    first, again = _steered(), Stick(ORIGINAL, _steered().flown())
    assert (again.time_s, again.headings_deg) == (52.0, list(HEADINGS))
    np.testing.assert_array_equal(first.poses(52.0)["evader"].position_m, again.poses(52.0)["evader"].position_m)


def test_what_is_seen_has_the_directions_of_the_map() -> None:
    stick = _steered()
    sight, flight = stick.sight(), fly_branch(ORIGINAL, stick.flown(), None)
    row = 52 * DRILL.rules.substeps
    here, gate = flight.evader.position_m[row, :2], np.array([DRILL.battlefield.length_m / 2, 0.0])
    assert np.cos(sight.exit_rad - azimuth(here, 0.0, gate)) == pytest.approx(1.0, abs=1e-5)
    for number, direction, range_m in sight.missiles:
        track = next(m for m in flight.missiles if m.number == number)
        assert np.cos(direction - azimuth(here, 0.0, track.position_m[row, :2])) == pytest.approx(1.0, abs=1e-5)
        assert range_m == pytest.approx(track.range_m[row], rel=1e-4)
    assert (sight.time_s, sight.speed_m_s) == (52.0, pytest.approx(flight.evader.speed_m_s[row]))


def test_from_the_first_moment_on() -> None:
    stick = Stick(ORIGINAL, Branch("A", 0, (), "drag"))
    np.testing.assert_array_equal(stick.poses(0.0)["evader"].position_m, ORIGINAL.evader.position_m[0])
    stick.step(0)
    assert stick.time_s == 1.0


def test_a_flight_that_is_over_stays_over() -> None:
    stick = Stick(ORIGINAL, START)
    for _ in range(DRILL.rules.max_steps):
        stick.step(0)
    assert stick.over
    flight = fly_branch(ORIGINAL, stick.flown(), None)
    assert flight.outcome is not Outcome.FLYING
    assert len(flight.action_rad) == 40 + len(stick.headings_deg)
    assert stick.poses(flight.duration_s)["evader"].position_m == pytest.approx(flight.evader.position_m[-1])


def test_a_flight_that_is_over_cannot_be_taken() -> None:
    with pytest.raises(BranchError, match="it is over"):
        Stick(ORIGINAL, Branch("A", len(ORIGINAL.action_rad), (), "drag"))


def test_a_flight_from_a_place_of_its_own_is_left_where_it_is() -> None:
    state = initial_states(DRILL, 77, np.array([4]))
    original = fly(task(), drag, "drag", seed=5, state=state)
    assert (original.evader.position_m[0] != ORIGINAL.evader.position_m[0]).any()
    branch = Branch("A", 10, (90,) * 5, "drag")
    flight, stick = fly_branch(original, branch, drag, state=state), Stick(original, branch, state)
    row = 10 * DRILL.rules.substeps
    np.testing.assert_array_equal(flight.evader.position_m[: row + 1], original.evader.position_m[: row + 1])
    np.testing.assert_array_equal(stick.poses(12.0)["evader"].position_m, flight.evader.position_m[12 * 20])
