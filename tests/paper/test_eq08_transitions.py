"""Eq. (8): what both tasks share moves alike; tasks part only when a masked missile would have been fired."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from sim.observation import keep_shared
from sim.world import Fate, World
from tests.engagements import Flights, drag, fly_lanes, launch_step, random_turns, task, to_exit

LANES = 48
STEPS = 220
TURNS = random_turns(STEPS, LANES, seed=3)
CHAIN = [(), (4,), (3, 4), (2, 3, 4), (1, 2, 3, 4)]


def flown(masked: tuple[int, ...]) -> Flights:
    return fly_lanes(World(task(*masked), LANES, seed=50), TURNS, steps=STEPS)


FLOWN = {masked: flown(masked) for masked in CHAIN}


def parting(big: Flights, small: Flights, lane: int, fresh: int) -> int:
    """Number of observations, from the first, before the fresh missile is fired."""
    fired = launch_step(big, lane, fresh)
    return STEPS + 1 if fired is None else fired


@pytest.mark.parametrize(("target", "source"), list(pairwise(CHAIN)), ids=str)
def test_neighbours_of_the_chain_fly_bit_identically_until_the_masked_missile_is_fired(
    target: tuple[int, ...], source: tuple[int, ...]
) -> None:
    big, small = FLOWN[target], FLOWN[source]
    (fresh,) = set(source) - set(target)
    layouts = task(*target).layout, task(*source).layout
    fired = 0
    for lane in range(LANES):
        until = parting(big, small, lane, fresh)
        fired += until <= STEPS
        shared = keep_shared(big.observation[:until, lane], *layouts)
        np.testing.assert_array_equal(shared, small.observation[:until, lane])
        # Rewards and ends belong to the transitions between these observations.
        np.testing.assert_array_equal(big.terms[: until - 1, lane], small.terms[: until - 1, lane])
        np.testing.assert_array_equal(big.terminated[: until - 1, lane], small.terminated[: until - 1, lane])
    assert fired > 0


@pytest.mark.parametrize(("target", "source"), list(pairwise(CHAIN)), ids=str)
def test_even_after_that_everything_but_the_missile_moves_alike(
    target: tuple[int, ...], source: tuple[int, ...]
) -> None:
    # A missile pushes nobody: the shared state goes on alike until the target's engagement ends.
    big, small = FLOWN[target], FLOWN[source]
    layouts = task(*target).layout, task(*source).layout
    for lane in range(LANES):
        until = int(min(big.steps[lane], small.steps[lane]))
        shared = keep_shared(big.observation[:until, lane], *layouts)
        np.testing.assert_array_equal(shared, small.observation[:until, lane])


def test_a_policy_that_ignores_the_masked_missile_flies_the_same_in_both_tasks() -> None:
    # Closed loop, as in training: the guide of a source task acts on Xi of the state.
    target, source = task(), task(2, 3, 4)

    def guide(observation: np.ndarray) -> np.ndarray:
        return drag(keep_shared(observation, target.layout, source.layout))

    big, small = fly_lanes(World(target, LANES, seed=50), guide), fly_lanes(World(source, LANES, seed=50), drag)
    for lane in range(LANES):
        until = int(min(big.steps[lane], small.steps[lane]))
        shared = keep_shared(big.observation[:until, lane], target.layout, source.layout)
        np.testing.assert_array_equal(shared, small.observation[:until, lane])


@pytest.mark.parametrize("masked", [(1,), (2,), (1, 3), (2, 4), (1, 2, 3)], ids=str)
def test_masks_off_the_chain_fly_alike_until_either_task_fires_another_missile(masked: tuple[int, ...]) -> None:
    # Off the chain the next unmasked missile takes the masked one's turn, so the source task may fire first.
    big, small = FLOWN[()], flown(masked)
    layouts = task().layout, task(*masked).layout
    for lane in range(LANES):
        differ = np.flatnonzero((big.fates[:, lane] != small.fates[:, lane]).any(axis=1))
        until = differ[0] if len(differ) else STEPS + 1
        shared = keep_shared(big.observation[:until, lane], *layouts)
        np.testing.assert_array_equal(shared, small.observation[:until, lane])


def test_tasks_do_part_after_the_launch() -> None:
    # The negative control: the last missile matters, or masking it would be pointless.
    ends = [fly_lanes(World(task(*masked), 96, seed=50), to_exit) for masked in (CHAIN[3], CHAIN[4])]
    assert (ends[0].outcome != ends[1].outcome).any()
    assert (ends[0].fates[..., 0] > Fate.UNLAUNCHED).any()
