"""Eq. (7): masking does not change where engagements begin."""

from __future__ import annotations

import numpy as np
import pytest

from sim.observation import keep_shared
from sim.world import World
from tests.engagements import MASKS, MISSILES, task

EPISODES = 200


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_every_task_starts_in_the_shared_part_of_the_targets_initial_states(masked: frozenset[int]) -> None:
    target, source = task(), task(*masked)
    whole = World(target, EPISODES, seed=40).observation
    begun = World(source, EPISODES, seed=40).observation
    np.testing.assert_array_equal(begun, keep_shared(whole, target.layout, source.layout))


def test_at_the_start_no_missile_flies_so_that_nothing_is_lost_by_masking() -> None:
    observation = World(task(), EPISODES, seed=40).observation
    for missile in MISSILES:
        block = observation[:, task().layout.block(missile)]
        np.testing.assert_array_equal(block, np.tile(np.array([-1.0, -np.pi], np.float32), (EPISODES, 1)))


def test_restarts_agree_as_well() -> None:
    target, source = World(task(), 3, seed=40), World(task(1, 3), 3, seed=40)
    for lanes in ([0], [2, 1], [0, 1, 2]):
        whole, part = target.reset(lanes=lanes), source.reset(lanes=lanes)
        np.testing.assert_array_equal(part, keep_shared(whole, task().layout, task(1, 3).layout))


def test_another_seed_is_another_start() -> None:
    # The negative control: equality above is not for want of variety.
    a, b = (World(task(), EPISODES, seed=seed).observation for seed in (40, 41))
    assert (a[:, :2] != b[:, :2]).all()
    assert len(np.unique(a[:, 0])) == EPISODES
