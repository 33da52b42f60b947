"""The replays of a stack hold what the replay of a training by itself holds, each its own."""

from __future__ import annotations

import numpy as np
import torch

from agents.replay import Replay
from agents.stacked.draws import Purpose, uniform
from agents.stacked.replay import StackedReplay

LANES, FEATURES, AGENTS = 4, 3, 3
SEEDS = torch.tensor([11, 12, 13])


def _fill(slots: int, capacity: int, clear_at: int = -1) -> tuple[StackedReplay, list[Replay]]:
    """The same random transitions in both; agent 1 forgets everything at slot `clear_at`."""
    draws = np.random.default_rng(0)
    stacked = StackedReplay(AGENTS, capacity, LANES, FEATURES, "cpu")
    alone = [Replay(capacity, LANES, FEATURES) for _ in range(AGENTS)]
    for slot in range(slots):
        if slot == clear_at:
            stacked.clear(1)
            alone[1] = Replay(capacity, LANES, FEATURES)
        observed, after = draws.normal(size=(2, AGENTS, LANES, FEATURES)).astype(np.float32)
        action, reward, imitation = draws.normal(size=(3, AGENTS, LANES)).astype(np.float32)
        terminated = draws.random((AGENTS, LANES)) < 0.1
        over = terminated | (draws.random((AGENTS, LANES)) < 0.1)
        scalars = np.stack((reward, imitation, terminated, over), axis=2).astype(np.float32)
        parts = (observed, action[..., None], scalars, after)
        stacked.add(*(torch.from_numpy(part) for part in parts))
        for place, one in enumerate(alone):
            mine = (action[place][:, None], reward[place], imitation[place], terminated[place], over[place])
            one.add(observed[place], *mine, after[place])
    return stacked, alone


def _compare(stacked: StackedReplay, alone: list[Replay], steps: int, monkeypatch_draws: int = 2) -> None:
    counts = torch.tensor([3, 5, 8])
    batches = list(stacked.minibatches(SEEDS[: len(alone)], counts[: len(alone)], monkeypatch_draws, 6, steps, 0.9))
    assert len(batches) == monkeypatch_draws
    for place, one in enumerate(alone):
        shares = uniform(SEEDS[place : place + 1], Purpose.TRANSITIONS, counts[place : place + 1], (12,))[0]
        theirs = list(_batches(one, shares, steps))
        for mine, expected in zip(batches, theirs, strict=True):
            for part, other in zip(mine, expected, strict=True):
                torch.testing.assert_close(part[place], other, rtol=1e-6, atol=1e-6)


def _batches(one: Replay, shares: torch.Tensor, steps: int):  # noqa: ANN202 - as Replay.minibatches
    drawn = torch.randint

    def randint(high: int, shape: tuple[int], generator: object) -> torch.Tensor:
        assert shape == tuple(shares.shape)
        return (shares * high).long()

    try:
        torch.randint = randint  # type: ignore[assignment]
        yield from one.minibatches(2, 6, steps, 0.9, torch.Generator())
    finally:
        torch.randint = drawn


def test_batches_are_those_of_a_replay_alone_before_and_after_the_ring_has_closed() -> None:
    for slots in (1, 3, 5, 12, 13, 31):
        for steps in (1, 4):
            _compare(*_fill(slots, capacity=12 * LANES), steps)


def test_an_agent_that_began_again_draws_only_from_what_it_has_seen_since() -> None:
    stacked, alone = _fill(9, capacity=6 * LANES, clear_at=7)
    assert stacked.size.tolist() == [24, 8, 24]
    _compare(stacked, alone, 4)


def test_nobody_draws_from_anybody_else() -> None:
    stacked, _ = _fill(9, capacity=6 * LANES)
    before = next(stacked.minibatches(SEEDS, torch.zeros(3, dtype=torch.int64), 1, 50, 3, 0.9))
    stacked.rows[2] = torch.nan
    after = next(stacked.minibatches(SEEDS, torch.zeros(3, dtype=torch.int64), 1, 50, 3, 0.9))
    for part, changed in zip(before, after, strict=True):
        assert torch.equal(part[:2], changed[:2])
    assert torch.isnan(after.reward[2]).all()


def test_those_who_stay_keep_their_experience_and_go_on_adding_to_it() -> None:
    stacked, alone = _fill(9, capacity=6 * LANES)
    smaller = stacked.take([2, 0])
    block = [torch.full((2, LANES, width), 5.0) for width in (FEATURES, 1, 4, FEATURES)]
    block[2][:] = 0.0
    smaller.add(*block)
    for one in (alone[2], alone[0]):
        zeros = np.zeros(LANES, np.float32)
        fives = np.full((LANES, FEATURES), 5.0, np.float32)
        one.add(fives, fives[:, :1], zeros, zeros, zeros > 0, zeros > 0, fives)
    _compare(smaller, [alone[2], alone[0]], 3)
    (_, rows), = smaller.blocks(1, smaller.added[1] - 1)  # fmt: skip
    assert (rows[:, :FEATURES] == 5.0).all()


def test_blocks_are_those_of_a_replay_alone() -> None:
    stacked, alone = _fill(9, capacity=6 * LANES)
    for first in (0, 5, 8, 9):
        mine, theirs = list(stacked.blocks(1, first)), list(alone[1].blocks(first))
        assert [number for number, _ in mine] == [number for number, _ in theirs]
        assert all(np.array_equal(a, b) for (_, a), (_, b) in zip(mine, theirs, strict=True))
