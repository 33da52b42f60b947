"""Eq. (11): the removed reward is the sum over the masked subtasks."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sim.reward import masked_reward
from sim.world import Fate, World
from tests.engagements import MASKS, MISSILES, drag, fly_lanes, task

FLIGHTS = fly_lanes(World(task(), 64, seed=61), drag)


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_it_adds_up_missile_by_missile(masked: frozenset[int]) -> None:
    one_by_one = sum((masked_reward(FLIGHTS.terms, [m]) for m in masked), np.zeros(FLIGHTS.terms.shape[:2]))
    np.testing.assert_array_equal(masked_reward(FLIGHTS.terms, masked), one_by_one)


def test_disjoint_masks_add() -> None:
    for size in range(5):
        for first in combinations(MISSILES, size):
            rest = set(MISSILES) - set(first)
            total = masked_reward(FLIGHTS.terms, first) + masked_reward(FLIGHTS.terms, rest)
            np.testing.assert_array_equal(total, masked_reward(FLIGHTS.terms, MISSILES))


def test_a_missile_is_worth_its_fate() -> None:
    # By hand: 50 for every evaded one, -400 for the one that hit, nothing for the others.
    worth = np.array([{Fate.EVADED: 50.0, Fate.HIT: -400.0}.get(fate, 0.0) for fate in Fate])
    for missile in MISSILES:
        returns = masked_reward(FLIGHTS.terms, [missile]).sum(axis=0)
        np.testing.assert_array_equal(returns, worth[FLIGHTS.fates[-1, :, missile - 1]])


def test_missiles_were_evaded_and_did_hit() -> None:
    assert set(np.unique(FLIGHTS.terms[..., 1:5])) == {-400.0, 0.0, 50.0}
