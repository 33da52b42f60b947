"""Eq. (6): Xi keeps what the source task sees, Psi what it does not."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from sim.observation import ObservationLayout, keep_masked, keep_shared
from tests.engagements import MASKS, task

TARGET = ObservationLayout((1, 2, 3, 4))
STATE = np.array([[10, 20, 0.1, 30, 0.2, 0.3, 0.4, 101, 1.1, 102, 1.2, 103, 1.3, 104, 1.4]], dtype=np.float32)
OWN = STATE[0, :7].tolist()


def listed(values: np.ndarray) -> list[float]:
    return [round(float(v), 6) for v in values[0]]


@pytest.mark.parametrize(
    ("missiles", "shared", "masked"),
    [
        ((1, 2, 3), [101, 1.1, 102, 1.2, 103, 1.3], [104, 1.4]),
        ((1,), [101, 1.1], [102, 1.2, 103, 1.3, 104, 1.4]),
        ((), [], [101, 1.1, 102, 1.2, 103, 1.3, 104, 1.4]),
        ((2, 4), [102, 1.2, 104, 1.4], [101, 1.1, 103, 1.3]),
        ((1, 2, 3, 4), [101, 1.1, 102, 1.2, 103, 1.3, 104, 1.4], []),
    ],
)
def test_by_hand(missiles: tuple[int, ...], shared: list[float], masked: list[float]) -> None:
    source = ObservationLayout(missiles)
    assert listed(keep_shared(STATE, TARGET, source)) == [*listed(STATE[:, :7]), *shared]
    assert listed(keep_masked(STATE, TARGET, source)) == masked


def test_going_down_the_chain_step_by_step_is_going_down_at_once() -> None:
    # Xi from task 0 to 1, 1 to 2, 2 to 3 and 3 to 4 is Xi from task 0 to 4.
    chain = [task(*range(5 - k, 5)).layout for k in range(5)]
    state = STATE
    for bigger, smaller in pairwise(chain):
        state = keep_shared(state, bigger, smaller)
    np.testing.assert_array_equal(state, keep_shared(STATE, chain[0], chain[4]))


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_a_task_sees_of_itself_everything(masked: frozenset[int]) -> None:
    layout = task(*masked).layout
    state = STATE[:, : layout.size]
    np.testing.assert_array_equal(keep_shared(state, layout, layout), state)
    assert keep_masked(state, layout, layout).shape == (1, 0)


def test_maps_take_whole_batches() -> None:
    batch = np.repeat(STATE, 32, axis=0)
    assert keep_shared(batch, TARGET, ObservationLayout((1,))).shape == (32, 9)
    assert keep_masked(batch, TARGET, ObservationLayout((1,))).shape == (32, 6)


def test_a_task_cannot_be_mapped_to_a_harder_one() -> None:
    with pytest.raises(ValueError, match="not in tuple"):
        keep_shared(STATE[:, :9], ObservationLayout((1,)), ObservationLayout((1, 2)))
