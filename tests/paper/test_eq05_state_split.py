"""Eq. (5): a target state is the source state and the masked state, side by side, nothing lost and nothing twice."""

from __future__ import annotations

import numpy as np
import pytest

from sim.world import World
from tests.engagements import DRILL, MASKS, task

PAIRS = [(a, b) for a in MASKS for b in MASKS if a <= b]


@pytest.mark.parametrize(("target", "source"), PAIRS, ids=str)
def test_shared_and_masked_columns_divide_the_target_state(target: frozenset[int], source: frozenset[int]) -> None:
    big, small = task(*target).layout, task(*source).layout
    shared, masked = big.shared_columns(small), big.masked_columns(small)
    assert sorted([*shared, *masked]) == list(range(big.size))
    assert len(shared) == small.size
    assert len(masked) == 2 * len(source - target)


@pytest.mark.parametrize(("target", "source"), PAIRS, ids=str)
def test_the_masked_state_is_about_masked_missiles_alone(target: frozenset[int], source: frozenset[int]) -> None:
    big, small = task(*target).layout, task(*source).layout
    about = {int(big.names[column].rpartition("_")[2]) for column in big.masked_columns(small)}
    assert about == source - target


def test_a_state_can_be_put_together_again() -> None:
    big, small = task().layout, task(2, 3).layout
    state = World(task(), 5).observation
    again = np.empty_like(state)
    again[:, big.shared_columns(small)] = state[:, big.shared_columns(small)]
    again[:, big.masked_columns(small)] = state[:, big.masked_columns(small)]
    np.testing.assert_array_equal(again, state)


def test_the_papers_case_cuts_the_vector_in_two() -> None:
    # Source task 1 masks missile 4: its state is the front of the target's, the masked state the last two numbers.
    big, small = task().layout, task(4).layout
    assert big.shared_columns(small).tolist() == list(range(13))
    assert big.masked_columns(small).tolist() == [13, 14]


def test_masking_leaves_the_action_alone() -> None:
    # The equation's premise, A of the target = A of the source.
    from sim.environment import action_space

    assert action_space().shape == (1,)
    assert all(World(task(*masked), 1).step([0.1]).observation.shape[0] == 1 for masked in MASKS)
    assert DRILL.launch.missiles == 4
