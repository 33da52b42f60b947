"""Angles seen from above: laws over many random angles, and corners."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.geometry import azimuth, wrap_to_pi
from tests.engagements import wrapped

ANGLES = np.random.default_rng(1).uniform(-40.0, 40.0, 5000)


def test_wrapped_angles_lie_above_minus_pi_and_up_to_pi() -> None:
    result = wrap_to_pi(ANGLES)
    assert (result > -math.pi).all()
    assert (result <= math.pi).all()


def test_wrapping_keeps_the_direction() -> None:
    np.testing.assert_allclose(np.cos(wrap_to_pi(ANGLES)), np.cos(ANGLES), atol=1e-12)
    np.testing.assert_allclose(np.sin(wrap_to_pi(ANGLES)), np.sin(ANGLES), atol=1e-12)


def test_wrapping_twice_is_wrapping_once() -> None:
    once = wrap_to_pi(ANGLES)
    np.testing.assert_array_equal(wrap_to_pi(once), once)


@pytest.mark.parametrize(
    ("angle", "expected"),
    [(0.0, 0.0), (math.pi, math.pi), (-math.pi, math.pi), (3 * math.pi, math.pi), (-0.5, -0.5), (4.0, 4.0 - math.tau)],
)
def test_corners_of_the_half_open_interval(angle: float, expected: float) -> None:
    # -pi is the default azimuth of a missile that does not fly: no true azimuth may ever be that.
    assert wrap_to_pi(angle) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("heading", "to", "expected"),
    [
        (0.0, (1.0, 0.0), 0.0),
        (0.0, (0.0, 1.0), math.pi / 2),
        (0.0, (0.0, -1.0), -math.pi / 2),
        (math.pi / 2, (0.0, 1.0), 0.0),
        (math.pi / 2, (1.0, 0.0), -math.pi / 2),
        (math.pi, (1.0, 1e-12), -math.pi),
        (math.pi / 4, (-1.0, 1.0), math.pi / 2),
    ],
)
def test_azimuth_is_left_positive(heading: float, to: tuple[float, float], expected: float) -> None:
    assert azimuth(np.zeros(2), heading, np.array(to)) == pytest.approx(expected, abs=1e-9)


def test_turning_by_the_azimuth_points_at_the_target() -> None:
    draw = np.random.default_rng(2)
    here, there = draw.normal(0.0, 1e5, (2, 1000, 2))
    heading = draw.uniform(-math.pi, math.pi, 1000)
    course = heading + azimuth(here, heading, there)
    bearing = np.arctan2(*(there - here).T[::-1])
    np.testing.assert_allclose(wrapped(course - bearing), 0.0, atol=1e-12)


def test_a_mirrored_engagement_has_the_opposite_azimuth() -> None:
    draw = np.random.default_rng(3)
    here, there = draw.normal(0.0, 1e5, (2, 1000, 2))
    heading = draw.uniform(-math.pi, math.pi, 1000)
    flip = np.array([1.0, -1.0])
    mirrored = azimuth(here * flip, -heading, there * flip)
    np.testing.assert_allclose(mirrored, -azimuth(here, heading, there), atol=1e-12)
