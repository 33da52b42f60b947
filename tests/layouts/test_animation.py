"""What an animation shows when, from where, and in which letters."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest

from layouts.animation import HOLD_S, frame_count, pictures
from layouts.animation_camera import Panel, Pose, camera, camera_flight, fit
from layouts.animation_time import SLOWER, engaged, frame_times
from layouts.picture_text import picture_text
from tests.layouts.sample import sample_flight

PANEL = Panel(100.0, 50.0, 640.0, 400.0)
BOX = np.array([(x, y, z) for x in (-110.0, 110.0) for y in (-40.0, 40.0) for z in (0.0, 40.0)])


def test_times_run_from_start_to_end_and_slower_while_missiles_fly() -> None:
    flight = sample_flight()
    times = frame_times([flight], 400)
    assert (times[0], times[-1]) == (0.0, pytest.approx(flight.duration_s))
    steps = np.diff(times)
    assert (steps > 0).all()
    flying = engaged([flight], times[:-1])
    assert 0.0 < flying.mean() <= 1.0
    assert steps.max() / steps.min() <= SLOWER + 1e-6
    if (~flying).any():
        assert steps[~flying].max() > steps[flying].min() * 1.5


def test_an_animation_is_never_slower_than_life() -> None:
    flight = sample_flight()
    assert frame_count([flight], 24.0, 20) == 24 * 20
    assert frame_count([flight], 10_000.0, 10) == round((flight.duration_s + HOLD_S) * 10)


def test_the_camera_sees_a_point_where_perspective_puts_it() -> None:
    """Straight from the south: 100 km away, 10 km to the right is 10 % of the focal length to the right."""
    view = camera(Pose(np.zeros(3), 100.0, 0.0, 0.0), PANEL)
    assert view.screen(np.zeros(3)) == pytest.approx([420.0, 250.0])
    assert view.screen(np.array([10.0, 0.0, 0.0])) == pytest.approx([420.0 + 0.1 * view.focal, 250.0])
    assert view.screen(np.array([0.0, 0.0, 5.0])) == pytest.approx([420.0, 250.0 + 0.05 * view.focal])
    assert np.isnan(view.screen(np.array([0.0, -101.0, 0.0]))).all()


def test_a_polygon_that_passes_behind_the_eye_is_cut() -> None:
    view = camera(Pose(np.zeros(3), 100.0, 0.0, 0.3), PANEL)
    ground = np.array([(-500.0, -500.0, 0.0), (500.0, -500.0, 0.0), (500.0, 500.0, 0.0), (-500.0, 500.0, 0.0)])
    outline = view.outline(ground)
    assert len(outline) >= 4
    assert np.isfinite(outline).all()


@pytest.mark.parametrize(("yaw", "tilt"), [(0.0, 0.66), (-0.62, 0.72), (0.0, math.radians(89))])
def test_all_that_shall_fit_fits_and_not_with_much_room(yaw: float, tilt: float) -> None:
    places = camera(fit(BOX, yaw, tilt, PANEL), PANEL).screen(BOX)
    low, high = places.min(axis=0), places.max(axis=0)
    assert (low >= (100.0, 50.0)).all() and (high <= (740.0, 450.0)).all()
    assert max((high - low) / (640.0, 400.0)) > 0.85


def test_the_camera_flies_to_the_action_without_a_jump_and_back() -> None:
    overview = fit(BOX, 0.0, 0.66, PANEL)
    near = np.array([(-5.0, -5.0, 38.0), (5.0, 5.0, 42.0)])
    flown = camera_flight(overview, [None] * 60 + [near] * 60 + [None] * 60, PANEL, 10.0)
    distances = np.array([pose.distance_km for pose in flown])
    assert distances[0] == pytest.approx(overview.distance_km)
    assert distances[90] < 0.5 * overview.distance_km
    assert distances[-1] == pytest.approx(overview.distance_km)
    assert np.abs(np.diff(np.log(distances))).max() < 0.15


def test_equal_flights_give_equal_pictures_and_others_do_not() -> None:
    flight = sample_flight()
    first, again = (list(pictures([flight], HOLD_S + 0.3, 10, 360)) for _ in range(2))
    assert len(first) == 23
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    other = next(pictures([replace(flight, policy="another")], HOLD_S + 0.3, 10, 360))
    assert not np.array_equal(other, first[0])


@pytest.mark.parametrize(
    ("name", "drawn"),
    [("submas-target", "submas-target"), ("ＡＢ", "AB"), ("\u0378", "\\u0378"), ("Łódź β ✓", "Łódź β ✓")],
)
def test_a_character_no_font_has_becomes_a_plainer_one_or_its_code(
    name: str, drawn: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("layouts.picture_text._family_with", lambda missing: [])
    assert picture_text(name) == (drawn, ["DejaVu Sans"])


def test_a_picture_of_a_name_in_another_script_draws_without_a_warning() -> None:
    """Matplotlib warns for every box it draws instead of a letter."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        next(pictures([replace(sample_flight(), policy="防御 🚀 策略")], HOLD_S + 0.3, 10, 360))
    assert not any("Last Resort" in family for family in picture_text("防御 🚀 策略")[1]), "boxes, without a warning"
