"""Table 1: the state spaces of the target task and the four source tasks, and what each number means."""

from __future__ import annotations

import numpy as np
import pytest

from sim.geometry import azimuth, wrap_to_pi
from sim.trajectory import fly
from sim.world import World
from tests.engagements import DRILL, drag, fly_lanes, task, wrapped

OWN = ["x", "y", "psi", "l", "theta_AA", "theta_ATA", "phi_exit"]
BLOCKS = ["r_1", "phi_1", "r_2", "phi_2", "r_3", "phi_3", "r_4", "phi_4"]


@pytest.mark.parametrize(
    ("masked", "name", "size"),
    [
        ((), "target", 15),
        ((4,), "source-1", 13),
        ((3, 4), "source-2", 11),
        ((2, 3, 4), "source-3", 9),
        ((1, 2, 3, 4), "source-4", 7),
    ],
)
def test_rows_of_the_table(masked: tuple[int, ...], name: str, size: int) -> None:
    assert task(*masked).name == name
    assert list(task(*masked).layout.names) == (OWN + BLOCKS)[:size]
    assert World(task(*masked), 2).observation.shape == (2, size)


def test_what_the_numbers_mean() -> None:
    trajectory = fly(task(), drag, "drag", seed=5)
    at = np.round(trajectory.step_time_s * DRILL.rules.substeps).astype(int)
    e, i = trajectory.evader, trajectory.interceptor
    place, other = e.position_m[at, :2], i.position_m[at, :2]
    exit_m = np.array([DRILL.battlefield.length_m / 2, DRILL.battlefield.exit_y_m])
    # AA: from the interceptor's tail to the line of sight, 0 when it is chased; ATA: from the nose to the interceptor.
    tail = wrap_to_pi(i.heading_rad[at] + np.pi)
    expected = {
        "x": place[:, 0],
        "y": place[:, 1],
        "psi": e.heading_rad[at],
        "l": np.linalg.norm(e.position_m[at] - i.position_m[at], axis=1),
        "theta_AA": azimuth(other, tail, place),
        "theta_ATA": azimuth(place, e.heading_rad[at], other),
        "phi_exit": azimuth(place, e.heading_rad[at], exit_m),
    }
    for column, name in enumerate(OWN):
        error = trajectory.observation[:, column] - expected[name]
        if name in ("x", "y", "l"):
            np.testing.assert_allclose(error, 0.0, atol=0.02)
        else:
            np.testing.assert_allclose(wrapped(error), 0.0, atol=2e-5)


def test_lengths_are_never_negative_and_angles_lie_in_the_half_open_interval() -> None:
    # Section 2.3: r >= 0 and phi in (-pi, pi], else the default vector [-1, -pi].
    observation = fly_lanes(World(task(), 64, seed=6), drag).observation.reshape(-1, 15)
    assert (observation[:, 3] >= 0.0).all()
    for column in (2, 4, 5, 6):
        assert (observation[:, column] > np.float32(-np.pi)).all()
        assert (observation[:, column] <= np.float32(np.pi)).all()
    for column in (7, 9, 11, 13):
        r, phi = observation[:, column], observation[:, column + 1]
        absent = r == -1.0
        assert (phi[absent] == np.float32(-np.pi)).all()
        assert (r[~absent] >= 0.0).all()
        assert (phi[~absent] > np.float32(-np.pi)).all()
        assert (phi[~absent] <= np.float32(np.pi)).all()
