"""A world that is driven where its arrays lie flies like one that is asked."""

from __future__ import annotations

import numpy as np
import pytest

from sim.device_world import DeviceWorld, truth_columns
from sim.task import task_for
from sim.world import Outcome, World

LANES = 20


@pytest.mark.parametrize("masked", [(), (1, 3)])
def test_it_flies_and_begins_anew_as_a_world_does(masked: tuple[int, ...]) -> None:
    task = task_for().mask(masked)
    usual, driven = World(task, LANES, seed=5), DeviceWorld(task, LANES, seed=5)
    draws = np.random.default_rng(0)
    columns, ended = truth_columns(task.layout), 0
    for _ in range(380):
        turns = np.clip(usual.observation[:, 6] + draws.normal(0.0, 0.2, LANES), -1.5, 1.5).astype(np.float32)
        step = usual.step(turns)
        driven.turns.numpy().ravel()[:LANES] = turns
        driven.advance()
        np.testing.assert_array_equal(driven.truth.numpy()[:LANES, columns], step.observation)
        np.testing.assert_array_equal(driven.terms.numpy()[:LANES], step.reward_terms)
        outcome = driven.outcomes.numpy().ravel()[:LANES]
        np.testing.assert_array_equal(outcome, usual.outcome)
        over = np.flatnonzero(outcome != Outcome.FLYING)
        if len(over):
            ended += len(over)
            usual.reset(lanes=over)
            driven.restart(over)
            np.testing.assert_array_equal(driven.truth.numpy()[:LANES, columns], usual.observation)
    assert ended > 0 and driven.next_episode == usual.next_episode


def test_columns_of_a_layout_are_found_among_those_of_all_missiles() -> None:
    full, some = task_for().layout, task_for().mask([2, 4]).layout
    assert truth_columns(full) == list(range(full.size))
    assert [full.names[column] for column in truth_columns(some)] == list(some.names)
