"""Policies times tasks: what is known of every cell, from the cache or from what comes with the workbench."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from agents.evaluation import Evaluation
from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.comparison.cache import ComparisonCache
from workbench.comparison.figures import CellFigures, flown_figures, shipped_figures
from workbench.comparison.policies import Entry, entry
from workbench.comparison.work import Work
from workbench.runs import RunStore


@dataclass(frozen=True)
class Cell:
    """One policy on one task."""

    entry: Entry
    task: Task
    work: Work | None
    """What flies it; None where the policy cannot."""
    evaluation: Evaluation | None
    """Every engagement, once it was flown here."""
    figures: CellFigures | None
    """Of that evaluation, else of the result set that comes with the workbench; None while there are none."""


@dataclass(frozen=True)
class Grid:
    """All cells of a comparison."""

    scenario: str
    seed: int
    episodes: int
    policies: tuple[str, ...]
    tasks: tuple[str, ...]
    cells: dict[tuple[str, str], Cell]
    """By policy and name of the task."""

    def cell(self, policy: str, task: str) -> Cell:
        """One cell."""
        return self.cells[policy, task]

    def unflown(self) -> list[Work]:
        """What has to be flown for every cell to hold its engagements."""
        return [cell.work for cell in self.cells.values() if cell.work is not None and cell.evaluation is None]

    def notes(self) -> list[str]:
        """Sentences without full stop: who cannot fly where, and who flies what it was not trained for; each once."""
        found = [f"{c.entry.spec} does not fly {c.task.name}: {c.entry.blind}" if c.entry.blind else c.entry.note
                 for c in self.cells.values()]  # fmt: skip
        return list(dict.fromkeys(filter(None, found)))

    def work(self, policy: str, task: str, kind: Any, **more: Any) -> Work | None:
        """Other work of a cell's policy; None where it cannot fly."""
        cell = self.cells[policy, task]
        seed = 0 if kind == "survival" else self.seed
        return None if cell.work is None else cell.entry.work(kind, self.scenario, cell.task, seed, **more)


def tasks_of(scenario: Scenario) -> dict[str, Task]:
    """Every task of a scenario by name: those of the chain first, from the easiest to the target, then the others."""
    numbers = range(1, scenario.launch.missiles + 1)
    masks = [
        frozenset(mask) for size in reversed(range(len(numbers) + 1)) for mask in itertools.combinations(numbers, size)
    ]
    tasks = [Task(scenario, mask) for mask in masks]
    chain = [task for task in tasks if task.missiles == tuple(range(1, len(task.missiles) + 1))]
    return {task.name: task for task in [*chain, *(task for task in tasks if task not in chain)]}


def build_grid(
    policies: Sequence[str], tasks: Iterable[str], scenario: str, episodes: int, seed: int, store: RunStore,
    cache: ComparisonCache,
) -> Grid:  # fmt: skip
    """Everything that is known of these policies on these tasks.

    Raises:
        ScenarioError: the scenario cannot be read.
    """
    known = tasks_of(load_scenario(scenario))
    chosen = [known[name] for name in tasks]
    cells = {}
    for policy in policies:
        for task in chosen:
            cells[policy, task.name] = _cell(entry(policy, task, store), task, scenario, episodes, seed, cache)
    return Grid(scenario, seed, episodes, tuple(policies), tuple(task.name for task in chosen), cells)


def _cell(found: Entry, task: Task, scenario: str, episodes: int, seed: int, cache: ComparisonCache) -> Cell:
    if found.blind:
        return Cell(found, task, None, None, None)
    work = found.work("evaluation", scenario, task, seed, episodes=episodes)
    evaluation = cache.evaluation(work)
    figures = flown_figures(evaluation, work) if evaluation else shipped_figures(work, task)
    return Cell(found, task, work, evaluation, figures)
