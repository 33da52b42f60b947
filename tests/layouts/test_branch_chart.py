"""The curves of a branch over those of its original."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from layouts.branch_chart import AROUND_S, BranchCharts, nearest_columns
from layouts.theme import BRANCH, POLICY_B
from sim.scenario_file import load_scenario
from sim.world import Outcome
from tests.layouts.sample import END_S, FLIGHT_S, LAUNCH_EVERY_S, sample_flight

FROM_S = 75.0


def _shown() -> BranchCharts:
    charts = BranchCharts(load_scenario())
    charts.show(sample_flight(), sample_flight(frozenset({4}), Outcome.SHOT_DOWN), FROM_S, "B", POLICY_B)
    return charts


def test_the_branch_is_drawn_from_its_moment_on_and_the_original_all_along() -> None:
    for overlay in (_shown()._azimuth, _shown()._nearest):
        assert overlay.original.data["time_s"][0] == 0.0
        assert overlay.branch.data["branch_time_s"][0] == FROM_S
        assert overlay.moment.location == FROM_S


def test_the_original_is_dotted_and_told_by_its_letter() -> None:
    charts = _shown()
    original, branch = charts._nearest.figure.renderers
    assert (original.glyph.line_color, branch.glyph.line_color) == (POLICY_B, BRANCH)
    assert original.glyph.line_dash
    assert not branch.glyph.line_dash
    assert [fig.title.text for fig in charts.figures] == [
        f"{what} · branch solid, B dotted" for what in ("Azimuths", "Closest missile", "Ground tracks")
    ]


def test_a_missile_that_the_branch_lacks_stays_empty() -> None:
    charts = _shown()
    assert np.isnan(charts._azimuth.branch.data["branch_missile_4_deg"]).all()
    assert np.isfinite(charts._azimuth.original.data["missile_4_deg"]).any()


def test_time_begins_shortly_before_the_moment_and_ends_shortly_after_the_last_missile() -> None:
    axis = _shown()._azimuth.figure.x_range
    last_s = 4 * LAUNCH_EVERY_S + FLIGHT_S  # missile 4 of the original; the branch has only three
    assert (axis.start, axis.end, axis.bounds) == (FROM_S - AROUND_S, last_s + AROUND_S, (0.0, END_S))


def test_the_closest_missile_is_the_nearest_that_flies() -> None:
    columns = nearest_columns(sample_flight())
    time, closest = columns["time_s"], columns["closest_km"]
    assert np.isnan(closest[time < LAUNCH_EVERY_S]).all()
    # Missile 1 is 1 km away in the middle of its flight, and 2 has just been launched 11 km away.
    assert closest[np.argmin(np.abs(time - (LAUNCH_EVERY_S + FLIGHT_S / 2)))] == 1.0


def test_without_missiles_there_is_no_closest_one() -> None:
    assert np.isnan(nearest_columns(sample_flight(frozenset({1, 2, 3, 4})))["closest_km"]).all()
    charts = BranchCharts(load_scenario())
    unarmed = sample_flight(frozenset({1, 2, 3, 4}))
    charts.show(unarmed, replace(unarmed), 0.0, "A", POLICY_B)
    assert charts._nearest.figure.y_range.end > 0.0
