"""The replay: a ring that loses nothing but the oldest, keeps both rewards apart, and sums steps within an episode."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from agents.replay import Batch, Replay

LANES = 2


def _add(replay: Replay, slot: int, terminated: bool = False, truncated: bool = False) -> None:
    """One step of two lanes; lane 1 has a thousand more in every number. Only lane 0 may end."""
    ids = slot + 1000.0 * np.arange(LANES, dtype=np.float32)
    ends, over = np.array([terminated, False]), np.array([terminated or truncated, False])
    replay.add(ids[:, None], ids[:, None] / 10_000, ids * 10, -ids, ends, over, ids[:, None] + 0.5)


def _filled(capacity: int, slots: int) -> Replay:
    replay = Replay(capacity, LANES, 1)
    for slot in range(slots):
        _add(replay, slot)
    return replay


def _path(replay: Replay, row: int, steps: int, gamma: float = 0.5) -> Batch:
    return replay.batch(torch.tensor([[row + LANES * step for step in range(steps)]]), gamma)


def test_every_column_comes_back_by_its_name() -> None:
    batch = _path(_filled(20, 3), row=3, steps=1)
    assert batch.features.tolist() == [[1001.0]]
    assert batch.action.item() == pytest.approx(0.1001)
    assert batch.reward.tolist() == [10_010.0] and batch.imitation.tolist() == [-1001.0]
    assert batch.discount.tolist() == [0.5] and batch.next_features.tolist() == [[1001.5]]


def test_several_steps_are_summed_and_discounted() -> None:
    batch = _path(_filled(20, 5), row=2, steps=3)
    # Slots 1, 2, 3 of lane 0: 10 + 20 / 2 + 30 / 4, and what follows slot 3 counts an eighth.
    assert batch.reward.tolist() == [27.5] and batch.imitation.tolist() == [-2.75]
    assert batch.discount.tolist() == [0.125] and batch.next_features.tolist() == [[3.5]]
    assert batch.features.tolist() == [[1.0]]


@pytest.mark.parametrize(("terminated", "discount"), [(True, 0.0), (False, 0.25)])
def test_a_sum_stops_where_its_episode_does(terminated: bool, discount: float) -> None:
    replay = Replay(20, LANES, 1)
    for slot in range(5):
        _add(replay, slot, terminated=slot == 2 and terminated, truncated=slot == 2 and not terminated)
    batch = _path(replay, row=2, steps=3)
    assert batch.reward.tolist() == [20.0]  # 10 + 20 / 2, nothing of the next episode
    assert batch.discount.tolist() == [discount] and batch.next_features.tolist() == [[2.5]]
    assert _path(replay, row=3, steps=3).next_features.tolist() == [[1003.5]]  # the other lane goes on


def test_the_oldest_slots_make_room() -> None:
    replay = _filled(8, 6)
    assert replay.size == 8 and replay.next_slot == 2
    assert sorted(replay.rows[:, 0].tolist()) == [2, 3, 4, 5, 1002, 1003, 1004, 1005]


@pytest.mark.parametrize("slots", [6, 10, 13, 27])
def test_no_sum_runs_from_the_newest_slot_into_the_oldest(slots: int) -> None:
    replay = _filled(20, slots)
    drawn = torch.cat(
        [batch.next_features - batch.features for batch in replay.minibatches(20, 64, 3, 0.9, _generator())]
    )
    assert torch.equal(drawn, torch.full_like(drawn, 2.5))  # always three consecutive steps of one lane


def test_batches_are_independent_and_cover_all_that_is_complete() -> None:
    replay = _filled(1000, 30)
    batches = list(replay.minibatches(20, 64, 4, 0.9, _generator()))
    assert len(batches) == 20 and all(len(batch.features) == 64 for batch in batches)
    assert not torch.equal(batches[0].features, batches[1].features)
    drawn = {value % 1000 for batch in batches for value in batch.features.flatten().tolist()}
    assert drawn == set(range(27))


def test_fewer_slots_than_steps_are_enough_to_begin() -> None:
    (batch,) = _filled(100, 2).minibatches(1, 16, 10, 0.5, _generator())
    assert set(batch.next_features.flatten().tolist()) == {1.5, 1001.5}


def _generator() -> torch.Generator:
    return torch.Generator().manual_seed(0)
