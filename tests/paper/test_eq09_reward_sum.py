"""Eq. (9): the reward is the final goal's, the subtasks' and the time's terms, summed."""

from __future__ import annotations

import numpy as np
import pytest

from sim.reward import total_reward
from sim.world import World
from tests.engagements import MASKS, changed, drag, fly_lanes, random_turns, task


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_the_reward_of_a_step_is_the_sum_of_its_terms(masked: frozenset[int]) -> None:
    world = World(task(*masked), 16, seed=8)
    for turn in random_turns(120, 16, seed=8):
        step = world.step(turn)
        np.testing.assert_array_equal(step.reward, total_reward(step.reward_terms))
        np.testing.assert_allclose(step.reward, step.reward_terms.astype(np.float64).sum(axis=1), atol=1e-4)


def test_in_random_worlds_as_well() -> None:
    draw = np.random.default_rng(12)
    for _ in range(8):
        worth = dict(zip(("exit", "evaded", "shot_down", "step"), draw.uniform(-100.0, 100.0, 4), strict=True))
        scenario = changed(reward=worth, launch={"interval_s": draw.uniform(3.0, 30.0)},
                           missile={"cd0": draw.uniform(0.3, 1.2), "fuse_m": draw.uniform(2.0, 40.0)})  # fmt: skip
        flights = fly_lanes(World(task(scenario=scenario), 16, seed=int(draw.integers(1000))), drag)
        paid = set(np.unique(flights.terms.round(3)))
        assert paid <= {np.float32(round(v, 3)) for v in (0.0, *worth.values())}
        # Every lane's return, computed from how it ended instead of from its terms.
        evaded = (flights.fates[-1] == 2).sum(axis=1)
        expected = evaded * worth["evaded"] + flights.steps * worth["step"]
        expected = expected + np.choose(flights.outcome, [0.0, worth["exit"], *[worth["shot_down"]] * 2, 0.0])
        got = total_reward(flights.terms.astype(np.float64)).sum(axis=0)
        np.testing.assert_allclose(got, expected, rtol=1e-5, atol=1e-2)
