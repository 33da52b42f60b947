"""The kernel's atmosphere against the published table and against the formulas its polynomials stand for."""

# ruff: noqa: ANN201  (kernels return nothing and say so by silence)
# Warp reads annotations of kernels at run time, so no `from __future__ import annotations` here.
import numpy as np
import pytest
import warp as wp
from numpy.typing import ArrayLike, NDArray

from sim.device import start_warp
from sim.kernel.atmosphere import density, sound_speed, temperature, thrust_share
from sim.reference_physics import air


@wp.kernel
def probe(altitude: wp.array(dtype=float), out: wp.array2d(dtype=float)):
    i = wp.tid()
    out[i, 0] = temperature(altitude[i])
    out[i, 1] = density(altitude[i])
    out[i, 2] = sound_speed(altitude[i])
    out[i, 3] = thrust_share(altitude[i])


def sample(altitude_m: ArrayLike) -> NDArray:
    """Temperature, density, speed of sound and share of thrust `[n, 4]` at altitudes `[n]` [m]."""
    start_warp()
    heights = np.atleast_1d(np.asarray(altitude_m, dtype=np.float32))
    out = wp.zeros((len(heights), 4), dtype=float, device="cpu")
    wp.launch(probe, dim=len(heights), inputs=[wp.array(heights, dtype=float, device="cpu"), out], device="cpu")
    return out.numpy()


@pytest.mark.parametrize(
    ("altitude_m", "kelvin", "kg_m3", "m_s"),
    [
        # ICAO Doc 7488, geopotential altitude.
        (0, 288.15, 1.2250, 340.294),
        (5000, 255.65, 0.73612, 320.529),
        (8000, 236.15, 0.52517, 308.063),
        (11000, 216.65, 0.36392, 295.069),
        (15000, 216.65, 0.19367, 295.069),
        (20000, 216.65, 0.08803, 295.069),
    ],
)
def test_atmosphere_is_the_standard_one(altitude_m: float, kelvin: float, kg_m3: float, m_s: float) -> None:
    np.testing.assert_allclose(sample(altitude_m)[0, :3], [kelvin, kg_m3, m_s], rtol=2e-4)


def test_the_polynomials_follow_the_formulas_from_below_the_sea_to_above_the_tropopause() -> None:
    heights = np.linspace(-400.0, 25e3, 4001).astype(np.float32)
    found = sample(heights)
    rho, sound = air(heights.astype(float))
    np.testing.assert_allclose(found[:, 1], rho, rtol=4e-6)
    np.testing.assert_allclose(found[:, 2], sound, rtol=4e-6)
    np.testing.assert_allclose(found[:, 3], (rho / 1.225) ** 0.7, rtol=4e-6)


def test_air_grows_thinner_and_never_stops() -> None:
    thickness = sample(np.linspace(0.0, 25e3, 500))[:, 1]
    assert (np.diff(thickness) < 0.0).all()
    assert (thickness > 0.0).all()
