"""Algorithm 3 and Fig. 5: a linear chain in which neighbours differ by one masked subtask."""

from __future__ import annotations

from agents.curriculum import build_curriculum
from sim.task import task_for
from tests.agents.point_robot import RobotTask


def test_the_four_missile_chain_of_fig_5() -> None:
    curriculum = build_curriculum(task_for(), (4, 3, 2, 1))
    assert [task.name for task in curriculum.tasks] == ["target", "source-1", "source-2", "source-3", "source-4"]
    assert curriculum.edges == ((1, 0), (2, 1), (3, 2), (4, 3))
    assert [sorted(task.masked) for task in curriculum.tasks] == [[], [4], [3, 4], [2, 3, 4], [1, 2, 3, 4]]


def test_any_order_of_subtasks_is_possible() -> None:
    curriculum = build_curriculum(RobotTask(), (1, 2))
    assert [sorted(task.masked) for task in curriculum.tasks] == [[], [1], [1, 2]]


def test_no_subtask_no_edge() -> None:
    curriculum = build_curriculum(RobotTask(), ())
    assert curriculum.edges == () and curriculum.target is curriculum.easiest
