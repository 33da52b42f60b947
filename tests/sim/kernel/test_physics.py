"""Physics functions against published tables and against geometry done another way."""

# ruff: noqa: ANN201  (kernels return nothing and say so by silence)
# Warp reads annotations of kernels at run time, so no `from __future__ import annotations` here.
import math

import numpy as np
import pytest
import warp as wp
from numpy.typing import NDArray

from sim.device import start_warp
from sim.kernel.physics import closest_approach, direction, drag_shape, proportional_navigation, turn_to


@wp.kernel
def probe_scalar(x: wp.array(dtype=float), out: wp.array2d(dtype=float)):
    i = wp.tid()
    out[i, 0] = drag_shape(x[i])


@wp.kernel
def probe_approach(before: wp.array(dtype=wp.vec3), after: wp.array(dtype=wp.vec3), out: wp.array(dtype=float)):
    i = wp.tid()
    out[i] = closest_approach(before[i], after[i])


@wp.kernel
def probe_guidance(offset: wp.array(dtype=wp.vec3), closing: wp.array(dtype=wp.vec3), out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    out[i] = proportional_navigation(offset[i], closing[i], 4.0)


@wp.kernel
def probe_direction(climb: wp.array(dtype=float), heading: wp.array(dtype=float), out: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    out[i] = direction(climb[i], heading[i])


@wp.kernel
def probe_turn(velocity: wp.array(dtype=wp.vec3), offset: wp.array(dtype=wp.vec3), out: wp.array(dtype=float)):
    i = wp.tid()
    out[i] = turn_to(velocity[i], offset[i])


@pytest.fixture(autouse=True, scope="module")
def warp() -> None:
    start_warp()


def scalars(kernel: wp.Kernel, values: NDArray | list[float], columns: int) -> NDArray:
    out = wp.zeros((len(values), columns), dtype=float, device="cpu")
    wp.launch(kernel, dim=len(values), inputs=[wp.array(values, dtype=float, device="cpu"), out], device="cpu")
    return out.numpy()


def vectors(kernel: wp.Kernel, *arrays: NDArray, kind: type = wp.vec3, out_kind: type = wp.vec3) -> NDArray:
    out = wp.zeros(len(arrays[0]), dtype=out_kind, device="cpu")
    inputs = [wp.array(a.astype(np.float32), dtype=kind, device="cpu") for a in arrays]
    wp.launch(kernel, dim=len(arrays[0]), inputs=[*inputs, out], device="cpu")
    return out.numpy()


def test_drag_shape_passes_through_its_points_and_is_continuous() -> None:
    mach = [0.3, 0.6, 1.0, 1.2, 2.0, 3.0, 4.0, 6.0]
    expected = [0.532, 0.532, 0.853, 1.0, 0.819, 0.630, 0.504, 0.504]
    np.testing.assert_allclose(scalars(probe_scalar, mach, 1)[:, 0], expected, atol=1e-6)
    fine = scalars(probe_scalar, np.linspace(0.0, 6.0, 6001), 1)[:, 0]
    # The steepest stretch rises by 0.8 per Mach: 0.0008 from one point to the next.
    assert abs(np.diff(fine)).max() < 1e-3


def test_a_turn_is_the_difference_of_two_headings() -> None:
    draw = np.random.default_rng(7)
    velocity, offset = draw.normal(0.0, 300.0, (500, 3)), draw.normal(0.0, 3e4, (500, 3))
    headings = [np.arctan2(v[:, 1], v[:, 0]) for v in (velocity, offset)]
    found = vectors(probe_turn, velocity, offset, out_kind=float)
    difference = np.angle(np.exp(1j * (headings[1] - headings[0])))
    np.testing.assert_allclose(found, difference, atol=2e-6)


def test_direction_is_a_unit_vector_with_heading_from_plus_x_and_climb_upwards() -> None:
    climb, heading = np.array([0.0, 0.0, np.pi / 2, 0.5]), np.array([0.0, np.pi / 2, 0.0, 1.0])
    out = vectors(probe_direction, climb, heading, kind=float)
    np.testing.assert_allclose(out[:3], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=3e-7)
    np.testing.assert_allclose(np.linalg.norm(out, axis=1), 1.0, atol=1e-6)


def random_moves(count: int) -> tuple[NDArray, NDArray]:
    draw = np.random.default_rng(6)
    before = draw.normal(0.0, 60.0, (count, 3))
    return before, before + draw.normal(0.0, 80.0, (count, 3))


def test_closest_approach_is_the_smallest_of_many_samples() -> None:
    before, after = random_moves(500)
    shares = np.linspace(0.0, 1.0, 20001)
    sampled = [np.linalg.norm(b + shares[:, None] * (a - b), axis=1).min() for b, a in zip(before, after, strict=True)]
    found = vectors(probe_approach, before, after, out_kind=float)
    # Samples lie at most half a stretch (about 3 mm) from the true minimum, which they never undercut.
    np.testing.assert_allclose(found, sampled, atol=5e-3)


def test_closest_approach_does_not_depend_on_how_a_move_is_cut() -> None:
    before, after = random_moves(500)
    middle = before + np.random.default_rng(8).uniform(0.0, 1.0, (500, 1)) * (after - before)
    whole = vectors(probe_approach, before, after, out_kind=float)
    halves = [vectors(probe_approach, *pair, out_kind=float) for pair in ((before, middle), (middle, after))]
    np.testing.assert_allclose(np.minimum(*halves), whole, atol=1e-4)


def test_a_pass_far_faster_than_the_substep_is_seen() -> None:
    # 1500 m/s head-on over 0.05 s is 75 m: both ends are 37 m away, and the pass itself is at 3 m.
    found = vectors(probe_approach, np.array([[37.5, 3.0, 0.0]]), np.array([[-37.5, 3.0, 0.0]]), out_kind=float)
    assert found[0] == pytest.approx(3.0, abs=1e-5)


def test_standing_still_is_a_distance() -> None:
    place = np.array([[3.0, 4.0, 12.0]])
    assert vectors(probe_approach, place, place, out_kind=float)[0] == pytest.approx(13.0)


def test_on_a_collision_course_navigation_asks_for_nothing() -> None:
    offset = np.array([[9000.0, -4000.0, 500.0]])
    command = vectors(probe_guidance, offset, -offset / 20.0)
    np.testing.assert_allclose(command, 0.0, atol=1e-4)


def test_navigation_is_constant_times_closing_speed_times_turn_of_the_line_of_sight() -> None:
    # 10 km ahead, closing at 1000 m/s, drifting left at 50 m/s: the line turns at 0.005 rad/s, 4 x 1000 x 0.005 = 20.
    command = vectors(probe_guidance, np.array([[10e3, 0.0, 0.0]]), np.array([[-1000.0, 50.0, 0.0]]))
    np.testing.assert_allclose(command, [[0.0, 20.0, 0.0]], rtol=1e-5, atol=1e-4)


def test_a_missile_that_is_being_outrun_is_not_steered() -> None:
    command = vectors(probe_guidance, np.array([[10e3, 0.0, 0.0]]), np.array([[10.0, 50.0, 0.0]]))
    np.testing.assert_allclose(command, 0.0)


def test_navigation_pulls_at_right_angles_to_the_line_of_sight() -> None:
    draw = np.random.default_rng(9)
    offset, closing = draw.normal(0.0, 1e4, (200, 3)), draw.normal(0.0, 800.0, (200, 3))
    command = vectors(probe_guidance, offset, closing)
    along = np.abs((command * offset).sum(axis=1)) / np.linalg.norm(offset, axis=1)
    assert (along <= 1e-4 * np.linalg.norm(command, axis=1) + 1e-3).all()
    assert math.isfinite(float(command.sum()))
