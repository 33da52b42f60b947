"""Scenarios by name: which ones a page offers, and what is said when a policy flies in another one than its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import ScenarioError, shorten
from sim.scenario_file import load_scenario, scenario_names
from workbench.runs import RunStore

if TYPE_CHECKING:
    from agents.policy import Policy
    from sim.task import Task

DEFAULT = "default"


def scenario_choices(store: RunStore) -> dict[str, str]:
    """Every scenario a page can show, label -> SCENARIO: the shipped ones, then the files that runs were trained on.

    A page opens nothing else, whatever its address says: a path in an address never becomes a file.
    """
    shipped = [DEFAULT, *(name for name in scenario_names() if name != DEFAULT)]
    files = sorted({run.config.scenario for run in store.list() if not run.problem} - set(shipped))
    return {name: name for name in shipped} | {_file_label(path): path for path in files if _loads(path)}


def scenario_label(spec: str) -> str:
    """A scenario in a word or two: its name, or the name of its file."""
    return shorten(Path(spec).name, 40)


def other_scenario(spec: str) -> str:
    """The scenario's label where it has to be said; empty for the default one."""
    return "" if spec == DEFAULT else scenario_label(spec)


def task_title(task: Task) -> str:
    """The task's name in titles, with its scenario where that is not the default one."""
    return task.name if task.scenario.name == DEFAULT else f"{task.name} of {task.scenario.name}"


def trained_elsewhere(policy: Policy, task: Task) -> str:
    """A sentence without its full stop if the policy's card names another scenario than the task's, else empty.

    Scenarios are told apart by their digest: a copy of a scenario under another name is the same world.
    """
    card = getattr(policy, "card", None)
    here = task.scenario
    if card is None or card.scenario_digest == here.digest:
        return ""
    trained = f"scenario '{card.scenario}' ({card.scenario_digest})"
    return f"policy '{policy.name}' was trained on {trained}, not on '{here.name}' ({here.digest})"


def _file_label(path: str) -> str:
    return f"{Path(path).name} ({Path(path).parent})"


def _loads(spec: str) -> bool:
    try:
        load_scenario(spec)
    except ScenarioError:
        return False
    return True
