"""What runs are measured against: the dragging expert's measured success, or a run that was pinned."""

from __future__ import annotations

from functools import cache, lru_cache

from sim.assets import asset_path
from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.reproduce.result_file import load
from workbench.run_index.record import RunRecord

EXPERT_LABEL = "Defensive-dragging expert"
EXPERT_SHORT = "Dragging expert"


@cache
def _measured() -> dict[tuple[str, str], float]:
    """Success rate of the expert by scenario digest and task, from the result set behind Fig. 13."""
    try:
        found = load(asset_path("results") / "fast" / "fig13.json")
    except (SubMasError, OSError):
        found = None
    numbers = found.numbers if found else ()
    return {
        (each.scenario_digest, each.task): each.success_rate for each in numbers if each.policy == "expert-dragging"
    }


@lru_cache(maxsize=256)
def expert_rate(scenario: str, subtasks: str) -> tuple[str, float | None]:
    """Name of the task with these missiles ("1,2") and the expert's success rate there; None if never measured."""
    wanted = {int(number) for number in subtasks.split(",") if number}
    try:
        target = Task(load_scenario(scenario))
        task = target.mask(missile for missile in target.missiles if missile not in wanted)
    except SubMasError:
        return f"missiles {subtasks}", None
    return task.name, _measured().get((task.scenario.digest, task.name))


def expert_rate_of(record: RunRecord) -> float | None:
    """The expert's success rate on the task that a run ends with."""
    return None if record.problem else expert_rate(record.scenario, record.subtasks)[1]
