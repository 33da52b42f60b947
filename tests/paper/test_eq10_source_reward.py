"""Eq. (10): the source task's reward is the target's without the masked subtasks' terms."""

from __future__ import annotations

import numpy as np
import pytest

from sim.reward import masked_reward, source_reward, total_reward
from sim.world import World
from tests.engagements import MASKS, drag, fly_lanes, random_turns, task

TARGET = fly_lanes(World(task(), 48, seed=60), drag)


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_removed_and_kept_rewards_make_up_the_whole(masked: frozenset[int]) -> None:
    whole = total_reward(TARGET.terms)
    np.testing.assert_allclose(
        source_reward(TARGET.terms, masked) + masked_reward(TARGET.terms, masked), whole, atol=1e-4
    )


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_it_is_the_sum_of_the_columns_that_stay(masked: frozenset[int]) -> None:
    kept = [c for c in range(6) if c not in masked]
    expected = TARGET.terms[..., kept].sum(axis=-1)
    np.testing.assert_allclose(source_reward(TARGET.terms, masked), expected, atol=1e-4)


@pytest.mark.parametrize("masked", [(4,), (3, 4), (2, 3, 4), (1, 2, 3, 4)], ids=str)
def test_the_source_task_pays_that_reward(masked: tuple[int, ...]) -> None:
    # Both tasks flown with the same turns: step by step the source's own reward, as long as both fly.
    turns = random_turns(200, 48, seed=60)
    big = fly_lanes(World(task(), 48, seed=60), turns, steps=200)
    small = fly_lanes(World(task(*masked), 48, seed=60), turns, steps=200)
    for lane in range(48):
        both = int(min(big.steps[lane], small.steps[lane]))
        expected = source_reward(big.terms[: both - 1, lane], masked)
        np.testing.assert_allclose(total_reward(small.terms[: both - 1, lane]), expected, atol=1e-4)


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_a_tasks_own_world_never_pays_a_masked_missile(masked: frozenset[int]) -> None:
    flights = fly_lanes(World(task(*masked), 16, seed=60), drag)
    assert not flights.terms[..., sorted(masked)].any()
