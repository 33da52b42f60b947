"""Initial states: random, inside their bounds, and a function of seed and episode number alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.start import initial_states
from tests.engagements import DRILL, changed

EPISODES = np.arange(2000)
STATES = initial_states(DRILL, 5, EPISODES)
EVADER_X, EVADER_Y, EVADER_ALTITUDE, EVADER_HEADING, EVADER_SPEED = range(5)
INTERCEPTOR_X, INTERCEPTOR_Y, INTERCEPTOR_ALTITUDE, INTERCEPTOR_HEADING, INTERCEPTOR_SPEED = range(5, 10)


def test_one_row_per_episode_and_one_range_factor_per_missile() -> None:
    assert STATES.shape == (2000, 34)
    assert initial_states(changed(launch={"missiles": 2}), 5, EPISODES[:3]).shape == (3, 22)


def test_nothing_but_the_launch_range_varies_until_a_scenario_says_so() -> None:
    assert (STATES[:, 14:] == 1.0).all()
    varied = initial_states(changed(variation={"interval_spread": 0.5, "lag_spread": 0.25}), 5, EPISODES)
    np.testing.assert_array_equal(varied[:, :14], STATES[:, :14])
    np.testing.assert_array_equal(varied[:, 18:30], 1.0)
    for block, spread in ((slice(14, 18), 0.5), (slice(30, 34), 0.25)):
        assert abs(varied[:, block] - 1.0).max() <= spread + 1e-6
        assert varied[:, block].std() == pytest.approx(spread / math.sqrt(3), rel=0.05)
    assert abs(np.corrcoef(varied[:, [*range(18), *range(30, 34)]].T) - np.eye(22)).max() < 5 / math.sqrt(2000)


@pytest.mark.parametrize(
    ("column", "low", "high"),
    [
        (EVADER_X, -33e3, -28e3),
        (INTERCEPTOR_X, 5e3, 20e3),
        (EVADER_Y, -15e3, 15e3),
        (INTERCEPTOR_Y, -15e3, 15e3),
        (EVADER_ALTITUDE, 7e3, 10e3),
        (INTERCEPTOR_ALTITUDE, 7e3, 10e3),
        (EVADER_HEADING, -0.3, 0.3),
        (INTERCEPTOR_HEADING, math.pi - 0.3, math.pi + 0.3),
        (EVADER_SPEED, 260.0, 300.0),
        (INTERCEPTOR_SPEED, 270.0, 310.0),
        (10, 0.8, 1.2),
        (13, 0.8, 1.2),
    ],
)
def test_columns_fill_their_interval_evenly(column: int, low: float, high: float) -> None:
    share = (STATES[:, column] - low) / (high - low)
    assert share.min() >= -1e-6
    assert share.max() <= 1.0 + 1e-6
    counts, _ = np.histogram(share, bins=10, range=(0.0, 1.0))
    # 200 expected in each tenth; five standard deviations are 67.
    assert abs(counts - 200).max() < 67


def test_columns_are_drawn_independently() -> None:
    correlation = np.corrcoef(STATES[:, :14].T)
    np.fill_diagonal(correlation, 0.0)
    # Five standard deviations of a correlation over 2000 draws.
    assert abs(correlation).max() < 5 / math.sqrt(2000)


def test_an_episode_does_not_depend_on_its_neighbours() -> None:
    for episode in (0, 1, 17, 1999):
        np.testing.assert_array_equal(initial_states(DRILL, 5, np.array([episode]))[0], STATES[episode])


def test_seeds_and_episodes_are_not_mixed_up() -> None:
    # With seed + episode as key, episode 1 of seed 0 would be episode 0 of seed 1.
    keys = [(0, 1), (1, 0), (1, 1), (0, 0), (2, 0), (0, 2)]
    rows = {initial_states(DRILL, seed, np.array([episode])).tobytes() for seed, episode in keys}
    assert len(rows) == len(keys)


def test_episodes_far_out_and_large_seeds_are_legal() -> None:
    assert np.isfinite(initial_states(DRILL, 2**62, np.array([10**12]))).all()


def test_both_aircraft_start_on_their_own_side() -> None:
    assert (STATES[:, EVADER_X] < STATES[:, INTERCEPTOR_X]).all()
