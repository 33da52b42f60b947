"""Algorithm 1: create tasks, build the curriculum, learn along it."""

from __future__ import annotations

from agents.curriculum import Curriculum, create_tasks, learn_with_curriculum
from tests.agents.point_robot import RobotTask


def test_two_to_the_n_minus_one_source_tasks_exist() -> None:
    tasks = create_tasks(RobotTask(), (1, 2))
    assert [sorted(task.masked) for task in tasks] == [[1], [2], [1, 2]]


def test_the_chain_uses_tasks_that_could_be_created_and_ends_in_the_target() -> None:
    seen: list[Curriculum] = []

    def learn(curriculum: Curriculum) -> str:
        seen.append(curriculum)
        return "policy"

    assert learn_with_curriculum(RobotTask(), (2, 1), learn) == "policy"
    assert seen[0].target == RobotTask()
    assert set(seen[0].tasks[1:]) <= set(create_tasks(RobotTask(), (1, 2)))
