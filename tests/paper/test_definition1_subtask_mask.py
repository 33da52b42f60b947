"""Definition 1: masking subtasks removes their states and rewards and makes a smaller, easier task."""

from __future__ import annotations

import numpy as np
import pytest

from sim.task import Task
from sim.world import Outcome, World
from tests.engagements import DRILL, MASKS, circle, drag, fly_lanes, task, to_exit

NAMES = [",".join(map(str, sorted(masked))) or "none" for masked in MASKS]


@pytest.mark.parametrize("masked", MASKS, ids=NAMES)
def test_related_states_are_removed_and_no_others(masked: frozenset[int]) -> None:
    target, source = task(), Task(DRILL, masked)
    removed = [name for name in target.layout.names if name not in source.layout.names]
    assert removed == [f"{kind}_{m}" for m in sorted(masked) for kind in ("r", "phi")]


@pytest.mark.parametrize("masked", MASKS, ids=NAMES)
def test_related_rewards_are_removed_and_no_others(masked: frozenset[int]) -> None:
    terms = np.abs(fly_lanes(World(Task(DRILL, masked), 48, seed=5), circle).terms).sum(axis=(0, 1))
    for missile in (1, 2, 3, 4):
        if missile in masked:
            assert terms[missile] == 0.0
    assert terms[-1] > 0.0


def test_the_missiles_that_stay_still_pay() -> None:
    terms = np.abs(fly_lanes(World(task(1, 3), 48, seed=5), drag).terms).sum(axis=(0, 1))
    assert terms[2] > 0.0
    assert terms[4] > 0.0


def test_masking_is_a_subset_relation() -> None:
    assert sum(Task(DRILL, masked) != task() for masked in MASKS) == 2**4 - 1


def test_tasks_with_fewer_missiles_are_easier() -> None:
    chain = [(), (4,), (3, 4), (2, 3, 4), (1, 2, 3, 4)]
    survived = [
        (fly_lanes(World(task(*masked), 96, seed=5), drag).outcome != Outcome.SHOT_DOWN).mean() for masked in chain
    ]
    assert survived == sorted(survived)
    assert survived[0] < survived[-1] == 1.0


def test_without_missiles_the_final_goal_remains() -> None:
    flights = fly_lanes(World(task(1, 2, 3, 4), 32, seed=5), to_exit)
    assert (flights.outcome == Outcome.EXIT).all()
    assert (flights.terms[..., 0].sum(axis=0) == 400.0).all()
