"""Eq. (12) in the simulator: while the masked missiles show the default vector, they pay nothing."""

from __future__ import annotations

import numpy as np
import pytest

from sim.observation import is_default, keep_masked
from sim.reward import masked_reward, source_reward, total_reward
from sim.world import Fate, World
from tests.engagements import MASKS, drag, fly_lanes, task

FLIGHTS = fly_lanes(World(task(), 96, seed=70), drag)
BEFORE, AFTER = FLIGHTS.observation[:-1], FLIGHTS.observation[1:]


def absent(observation: np.ndarray, masked: frozenset[int]) -> np.ndarray:
    """Psi(s) equals the default vector, `[K, L]`."""
    layouts = task().layout, task(*masked).layout
    flat = keep_masked(observation.reshape(-1, 15), *layouts)
    return is_default(flat).reshape(observation.shape[:2])


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_absent_missiles_pay_nothing(masked: frozenset[int]) -> None:
    paid = masked_reward(FLIGHTS.terms, masked)
    quiet = absent(BEFORE, masked)
    assert not paid[quiet].any()
    if masked:
        assert quiet.any()
        assert (paid[~quiet] != 0.0).any()


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_source_and_target_reward_are_then_the_same(masked: frozenset[int]) -> None:
    quiet = absent(BEFORE, masked)
    np.testing.assert_array_equal(source_reward(FLIGHTS.terms, masked)[quiet], total_reward(FLIGHTS.terms)[quiet])


def test_the_default_vector_shows_exactly_when_a_missile_does_not_fly() -> None:
    for missile in (1, 2, 3, 4):
        flying = FLIGHTS.fates[:, :, missile - 1] == Fate.FLYING
        np.testing.assert_array_equal(absent(FLIGHTS.observation, frozenset({missile})), ~flying)


def test_a_missile_that_was_evaded_is_absent_again() -> None:
    evaded = FLIGHTS.fates[-1] == Fate.EVADED
    assert evaded.any()
    for lane, index in zip(*np.nonzero(evaded), strict=True):
        block = FLIGHTS.observation[-1, lane, task().layout.block(int(index) + 1)]
        np.testing.assert_array_equal(block, np.array([-1.0, -np.pi], np.float32))


def test_no_missile_is_fired_and_ends_within_one_step() -> None:
    # Else it could pay in a step whose observation shows it absent. An arming time above a step rules that out.
    for missile in range(4):
        fates = FLIGHTS.fates[:, :, missile]
        jump = (fates[:-1] == Fate.UNLAUNCHED) & (fates[1:] >= Fate.EVADED)
        assert not jump.any()
