"""Algorithm 5: from the expert's task to the target, each policy guiding the next."""

from __future__ import annotations

from typing import Any

from agents.curriculum import build_curriculum
from agents.expert import NavigationExpert
from agents.policy import Policy
from agents.submas import submas
from sim.task import task_for


class Named(NavigationExpert):
    def __init__(self, name: str) -> None:
        self.name = name


def test_every_stage_is_guided_by_the_policy_of_the_stage_before() -> None:
    calls: list[tuple[int, str, str, str]] = []

    def learn_stage(number: int, task: Any, source: Any, guide: Policy) -> Policy:
        calls.append((number, task.name, source.name, guide.name))
        return Named(f"policy of {task.name}")

    curriculum = build_curriculum(task_for(), (4, 3, 2, 1))
    result = submas(curriculum, NavigationExpert(), learn_stage)
    assert calls == [
        (0, "source-3", "source-4", "expert-navigation"),
        (1, "source-2", "source-3", "policy of source-3"),
        (2, "source-1", "source-2", "policy of source-2"),
        (3, "target", "source-1", "policy of source-1"),
    ]
    assert result.name == "policy of target"
