"""Fig. 11: the expert keeps the closest missile at a right angle, and flies to the exit when none flies."""

from __future__ import annotations

import numpy as np
import pytest

from agents.expert import DraggingExpert, NavigationExpert
from agents.policy import bind
from sim.trajectory import Trajectory, fly
from sim.world import Outcome, World
from tests.engagements import fly_lanes, task

EXPERT = DraggingExpert()
FLIGHTS = [fly(task(), bind(EXPERT, task()), EXPERT.name, seed=9, episode=e) for e in range(10)]


def closest(flight: Trajectory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Number (0 none), azimuth [rad] and range [m] of the closest missile at each decision `[K]`."""
    ranges = np.where(flight.observation[:, 7::2] < 0.0, np.inf, flight.observation[:, 7::2])
    nearest = ranges.argmin(axis=1)
    rows = np.arange(len(ranges))
    flying = np.isfinite(ranges[rows, nearest])
    return np.where(flying, nearest + 1, 0), flight.observation[rows, 8 + 2 * nearest], ranges[rows, nearest]


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: f"episode {flight.episode}")
def test_the_closest_missile_is_kept_at_a_right_angle(flight: Trajectory) -> None:
    number, azimuth, distance = closest(flight)
    # Time to turn: the same missile has been the closest for ten seconds, and is not yet upon us.
    settled = np.array([k >= 10 and len(set(number[k - 10 : k + 1])) == 1 for k in range(len(number))])
    held = settled & (number > 0) & (distance > 3e3)
    assert held.any()
    assert np.abs(np.abs(np.degrees(azimuth[held])) - 90.0).max() < 12.0


def test_other_missiles_are_ignored() -> None:
    # The same state with another missile farther away: the same turn.
    state = FLIGHTS[0].observation[[0]].astype(np.float32)
    alone, beside = state.copy(), state.copy()
    alone[0, 7:9] = (9e3, 1.0)
    beside[0, 7:9], beside[0, 11:13] = (9e3, 1.0), (15e3, -2.0)
    layout = task().layout
    np.testing.assert_array_equal(EXPERT.act(alone, layout), EXPERT.act(beside, layout))


def test_without_missiles_it_navigates() -> None:
    state = FLIGHTS[0].observation[[0]].astype(np.float32)
    layout = task().layout
    np.testing.assert_array_equal(EXPERT.act(state, layout), NavigationExpert().act(state, layout))
    easiest = task(1, 2, 3, 4)
    assert (fly_lanes(World(easiest, 16, seed=9), bind(EXPERT, easiest)).outcome == Outcome.EXIT).all()


def test_dragging_survives_more_often_than_flying_on() -> None:
    survived = [
        (fly_lanes(World(task(), 64, seed=9), bind(policy, task())).outcome != Outcome.SHOT_DOWN).mean()
        for policy in (EXPERT, NavigationExpert())
    ]
    assert survived[0] > survived[1]
