"""Work that is quickly done."""

from __future__ import annotations

from sim.task import Task, task_for
from workbench.comparison.policies import entry
from workbench.comparison.work import Work
from workbench.runs import RunStore

SEED = 2**46
ONE_MISSILE = task_for("default", "2,3,4")


def some_work(store: RunStore, policy: str = "expert-dragging", task: Task = ONE_MISSILE, episodes: int = 20) -> Work:
    return entry(policy, task, store).work("evaluation", "default", task, SEED, episodes=episodes)
