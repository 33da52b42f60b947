"""Cameras show what they promise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from layouts.cameras import FIELD_OF_VIEW_RAD, Vector, chase, overview
from layouts.motion import motion
from tests.layouts.sample import sample_flight


def _seen(position: Vector, target: Vector, point: Vector, aspect: float) -> tuple[float, float]:
    """Where a point is in the image: -1 to 1 from edge to edge, in both directions."""
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    offset = point - position
    scale = (offset @ forward) * math.tan(FIELD_OF_VIEW_RAD / 2)
    return float(offset @ right / scale / aspect), float(offset @ up / scale)


@pytest.mark.parametrize("aspect", [1.0, 2.0, 3.4])
@pytest.mark.parametrize("top", [False, True])
def test_the_overview_holds_all_corners(aspect: float, top: bool) -> None:
    width, depth = 484.0, 120.0
    position, target = overview(width, depth, aspect, top)
    for x in (-width / 2, width / 2):
        for y in (-depth / 2, depth / 2):
            for z in (0.0, 28.0):
                across, upward = _seen(position, target, np.array([x, y, z]), aspect)
                assert abs(across) < 1.12
                assert abs(upward) < 1.12


@pytest.mark.parametrize("aspect", [1.0, 2.0, 3.4])
@pytest.mark.parametrize("top", [False, True])
def test_spare_height_is_above_the_battlefields_where_read_outs_stand(aspect: float, top: bool) -> None:
    width, depth = 484.0, 60.0
    position, target = overview(width, depth, aspect, top)
    _, foot = _seen(position, target, np.array([0.0, -depth / 2, 0.0]), aspect)
    _, head = _seen(position, target, np.array([0.0, depth / 2, 12.0]), aspect)
    assert foot == pytest.approx(-0.72)
    assert head < 0.3


def test_the_chase_camera_is_behind_and_above_and_looks_ahead() -> None:
    flight = sample_flight()
    path = motion(flight.evader, flight.time_s, 4.0, np.zeros(3))
    position, target = chase(path, 100.0)
    here = path.position(100.0)
    assert position[0] < here[0] < target[0]
    assert position[2] > here[2]


@pytest.mark.parametrize("time_s", [0.0, 200.0, 999.0])
def test_the_chase_camera_stays_put_at_both_ends(time_s: float) -> None:
    flight = sample_flight()
    path = motion(flight.evader, flight.time_s, 4.0, np.zeros(3))
    assert np.isfinite(np.concatenate(chase(path, time_s))).all()
