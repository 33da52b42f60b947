"""Exploration noise: of the given size, each lane its own, fresh at every step or held as long as it should be."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from agents.exploration import held_noise

LANES, STEPS = 50, 2000


def draws(steps: int, restarts: tuple[int, ...] = ()) -> NDArray:
    """Noise `[STEPS, LANES]` with a deviation of 0.2; every lane restarts at the given steps."""
    generator, noise, rows = np.random.default_rng(0), np.zeros((LANES, 1), np.float32), []
    for step in range(STEPS):
        restarted = np.full(LANES, step == 0 or step in restarts)
        noise = held_noise(noise, restarted, 0.2, steps, generator)
        rows.append(noise[:, 0])
    return np.array(rows)


def test_one_step_means_fresh_noise_at_every_step_and_in_every_lane() -> None:
    noise = draws(1)
    assert len(np.unique(noise)) > 0.999 * noise.size
    assert noise.std() == pytest.approx(0.2, rel=0.02)
    assert abs(np.corrcoef(noise[:-1].ravel(), noise[1:].ravel())[0, 1]) < 0.02


def test_held_noise_changes_once_in_that_many_steps_and_keeps_its_size() -> None:
    noise = draws(20)
    changes = (noise[1:] != noise[:-1]).mean()
    assert changes == pytest.approx(1 / 20, rel=0.05)
    assert noise.std() == pytest.approx(0.2, rel=0.05)
    # Lanes do not change together.
    assert ((noise[1:] != noise[:-1]).mean(axis=1) < 0.5).all()


def test_a_new_episode_begins_with_a_draw_of_its_own() -> None:
    noise = draws(1000, restarts=(100, 900))
    for step in (100, 900):
        assert (noise[step] != noise[step - 1]).all()
