"""The replay: a ring that loses nothing but the oldest, and keeps both rewards apart."""

from __future__ import annotations

import numpy as np
import torch

from agents.replay import Replay


def _add(replay: Replay, first: int, count: int) -> None:
    ids = np.arange(first, first + count, dtype=np.float32)
    replay.add(ids[:, None], ids[:, None] / 1000, ids * 10, -ids, ids.astype(int) % 2 == 1, ids[:, None] + 0.5)


def test_every_column_comes_back_by_its_name() -> None:
    replay = Replay(8, 1)
    _add(replay, 1, 3)
    batch = replay.batch(replay.rows[:3])
    assert batch.features.flatten().tolist() == [1, 2, 3]
    torch.testing.assert_close(batch.action, torch.tensor([[0.001], [0.002], [0.003]]))
    assert batch.reward.tolist() == [10, 20, 30]
    assert batch.imitation.tolist() == [-1, -2, -3]
    assert batch.terminated.tolist() == [1, 0, 1]
    assert batch.next_features.flatten().tolist() == [1.5, 2.5, 3.5]


def test_the_oldest_make_room_across_the_end_of_the_ring() -> None:
    replay = Replay(10, 1)
    for first in (0, 4, 8):
        _add(replay, first, 4)
    assert replay.size == 10 and replay.next_row == 2
    kept = sorted(replay.batch(replay.rows).features.flatten().tolist())
    assert kept == list(range(2, 12))


def test_batches_are_independent_and_cover_only_what_is_stored() -> None:
    replay = Replay(1000, 1)
    _add(replay, 0, 50)
    batches = list(replay.minibatches(20, 64, torch.Generator().manual_seed(0)))
    assert len(batches) == 20 and all(len(batch.features) == 64 for batch in batches)
    assert not torch.equal(batches[0].features, batches[1].features)
    drawn = torch.cat([batch.features for batch in batches]).flatten()
    assert set(drawn.tolist()) == set(range(50))
    assert abs(drawn.mean().item() - 24.5) < 1.5
