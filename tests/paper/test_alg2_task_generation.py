"""Algorithm 2: task generation, line by line."""

from __future__ import annotations

import pytest

from sim.environment import action_space
from sim.observation import keep_masked, keep_shared
from sim.task import Task
from sim.world import World
from tests.engagements import DRILL, MASKS, MISSILES, task


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_line_1_removes_the_masked_subtasks(masked: frozenset[int]) -> None:
    for target in (Task(DRILL, other) for other in MASKS):
        assert set(target.mask(masked).missiles) == set(target.missiles) - masked


def test_line_2_keeps_the_actions() -> None:
    # One action space for all tasks; none is made per task.
    for masked in MASKS:
        World(Task(DRILL, masked), 1).step(action_space().sample())


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_lines_3_and_4_split_the_state_and_give_both_maps(masked: frozenset[int]) -> None:
    target, source = task(), task().mask(masked)
    state = World(target, 4).observation
    kept, removed = (f(state, target.layout, source.layout) for f in (keep_shared, keep_masked))
    assert kept.shape == (4, source.layout.size)
    assert removed.shape == (4, 2 * len(masked))


def test_lines_5_to_7_leave_the_world_alone() -> None:
    # Initial states, transitions and rewards are the scenario's, which the source task shares.
    assert all(task().mask(masked).scenario is DRILL for masked in MASKS)


def test_the_target_contains_every_task_it_generates() -> None:
    assert all(task().contains(task().mask(masked)) for masked in MASKS)


def test_generating_in_steps_or_at_once_is_the_same() -> None:
    step_by_step = task()
    for missile in (4, 3, 2, 1):
        step_by_step = step_by_step.mask([missile])
    assert step_by_step == task().mask(MISSILES)


def test_different_masks_generate_different_tasks() -> None:
    assert len({task().mask(masked) for masked in MASKS}) == 16
