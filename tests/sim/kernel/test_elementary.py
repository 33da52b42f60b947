"""The kernel's sine, cosine and arctangent against NumPy's, and angles that stay where angles belong."""

# ruff: noqa: ANN201  (kernels return nothing and say so by silence)
# Warp reads annotations of kernels at run time, so no `from __future__ import annotations` here.
import numpy as np
import warp as wp
from numpy.typing import NDArray

from sim.device import start_warp
from sim.kernel.elementary import arctangent, cosine, near_cosine, near_sine, sine, wrap_to_pi

PI = np.float32(np.pi)


@wp.kernel
def probe(x: wp.array(dtype=float), y: wp.array(dtype=float), out: wp.array2d(dtype=float)):
    i = wp.tid()
    out[i, 0] = sine(x[i])
    out[i, 1] = cosine(x[i])
    out[i, 2] = near_sine(x[i])
    out[i, 3] = wrap_to_pi(x[i])
    out[i, 4] = arctangent(y[i], x[i])
    out[i, 5] = near_cosine(x[i])


def sample(x: NDArray, y: NDArray | None = None) -> NDArray:
    """Sine, cosine, near sine and wrapped angle of x, and the angle of the point (x, y), near cosine: `[n, 6]`."""
    start_warp()
    values = [np.asarray(v, dtype=np.float32) for v in (x, np.zeros_like(x) if y is None else y)]
    out = wp.zeros((len(x), 6), dtype=float, device="cpu")
    wp.launch(probe, dim=len(x), inputs=[*(wp.array(v, dtype=float, device="cpu") for v in values), out], device="cpu")
    return out.numpy()


def test_sine_and_cosine_are_good_to_the_resolution_of_a_float32_angle() -> None:
    angles = np.linspace(-PI, PI, 20001).astype(np.float32)
    found = sample(angles)
    np.testing.assert_allclose(found[:, 0], np.sin(angles.astype(float)), atol=2.5e-7)
    np.testing.assert_allclose(found[:, 1], np.cos(angles.astype(float)), atol=2.5e-7)
    near = np.abs(angles) <= np.pi / 2
    np.testing.assert_allclose(found[near, 2], np.sin(angles[near].astype(float)), atol=1.5e-7)
    np.testing.assert_allclose(found[near, 5], np.cos(angles[near].astype(float)), atol=1.5e-7)
    assert sample(np.zeros(1))[0, 1] == 1.0


def test_the_angle_of_a_point_is_right_in_all_quadrants_and_on_the_axes() -> None:
    angles = np.linspace(-np.pi, np.pi, 20001)
    radius = 10.0 ** np.random.default_rng(1).uniform(-3, 5, len(angles))
    x, y = (radius * np.cos(angles)).astype(np.float32), (radius * np.sin(angles)).astype(np.float32)
    np.testing.assert_allclose(sample(x, y)[1:-1, 4], np.arctan2(y, x)[1:-1], atol=4e-7)
    axes = sample(np.array([1.0, 0.0, -1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0, -1.0, 0.0]))[:, 4]
    np.testing.assert_allclose(axes, [0.0, np.pi / 2, np.pi, -np.pi / 2, 0.0], atol=1e-7)


def test_no_point_has_the_angle_minus_pi() -> None:
    # It belongs to the default vector of a missile that does not fly (section 2.3).
    backwards = sample(np.full(5, -1e5), np.array([0.0, -0.0, -1e-4, 1e-4, -1e-30]))[:, 4]
    assert (backwards > -PI).all()


def test_wrapped_angles_stay_in_the_half_open_interval() -> None:
    angles = np.random.default_rng(4).uniform(-9.4, 9.4, 20000).astype(np.float32)
    edges = np.array([np.pi, -np.pi], dtype=np.float32)
    edges = np.concatenate([edges, np.nextafter(edges, np.float32(9)), np.nextafter(edges, np.float32(-9))])
    wrapped = sample(np.concatenate([angles, edges]))[:, 3]
    assert (wrapped > -PI).all()
    assert (wrapped <= PI).all()
    np.testing.assert_allclose(np.cos(wrapped[:20000]), np.cos(angles), atol=2e-6)
    np.testing.assert_allclose(np.sin(wrapped[:20000]), np.sin(angles), atol=2e-6)
