"""What a person chooses on the Compare page: policies, tasks, scenario, engagements, and what to look at closely."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui

from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.comparison.grid import tasks_of
from workbench.pages.compare_settings import (
    FEWEST,
    MOST,
    POLICIES_MOST,
    TASKS_MOST,
    CompareSettings,
    chain_tasks,
    looked_at,
)
from workbench.pages.fly_settings import SEED_MAX
from workbench.pages.number_field import NumberField

EPISODES_WORDS = "From so many initial states each policy flies on each task"
SEED_WORDS = (
    "With the episode's number it fixes each initial state, for all policies alike; "
    "the usual one is that of the reported figures, which no training ever sees"
)


class CompareControls:
    """The widgets; `on_change` is called once for whatever a person changes."""

    def __init__(
        self,
        settings: CompareSettings,
        labels: Mapping[str, str],
        scenarios: Mapping[str, str],
        on_change: Callable[[], None],
    ) -> None:
        self._labels, self._on_change = dict(labels), on_change
        self._quiet = False
        self._policies = _many("Policies", {label: spec for spec, label in labels.items()}, POLICIES_MOST)
        self._tasks = _many("Tasks (missiles that fly)", {}, TASKS_MOST)
        self._scenario = _one("Scenario", dict(scenarios), "0 1 190px")
        self._episodes = _number("Engagements each", FEWEST, MOST, 150, EPISODES_WORDS)
        self._seed = _number("Seed", 0, SEED_MAX, 225, SEED_WORDS)
        self._task, self._policy, self._against = (
            _one(label, {}, "0 1 240px") for label in ("Look closely at task", "Policy", "Paired with")
        )
        self.fill(settings)
        self._scenario.param.watch(self._change_scenario, "value")
        chosen = (self._policies, self._tasks, self._episodes, self._seed, self._task, self._policy, self._against)
        for widget in chosen:
            widget.param.watch(lambda *_events: self._changed(), "value")
        self.what: list[pn.viewable.Viewable] = [self._policies, self._tasks]
        self.how: list[pn.viewable.Viewable] = [self._scenario, self._episodes, self._seed]
        self.closely: list[pn.viewable.Viewable] = [self._task, self._policy, self._against]

    def settings(self) -> CompareSettings:
        """What is chosen now; tasks from the easiest to the hardest."""
        scenario = self._scenario.value
        tasks = tuple(name for name in self._tasks.options.values() if name in self._tasks.value)
        episodes, seed = self._episodes.value, self._seed.value
        closely = (self._task.value or "", self._policy.value or "", self._against.value or "")
        return looked_at(CompareSettings(tuple(self._policies.value), tasks, scenario, episodes, seed, *closely))

    def fill(self, settings: CompareSettings) -> None:
        """Show these settings, without telling of a change."""
        self._quiet = True
        tasks = {task_words(task): name for name, task in tasks_of(load_scenario(settings.scenario)).items()}
        self._policies.value = list(settings.policies)
        self._tasks.param.update(options=tasks, value=list(settings.tasks))
        self._scenario.value = settings.scenario
        self._episodes.value, self._seed.value = settings.episodes, settings.seed
        words = {name: label for label, name in tasks.items()}
        self._task.param.update(options={words[name]: name for name in settings.tasks}, value=settings.task or None)
        policies = {self._labels[spec]: spec for spec in settings.policies}
        self._policy.param.update(options=policies, value=settings.policy or None)
        self._against.param.update(options=policies, value=settings.against or None)
        self._quiet = False

    def _changed(self) -> None:
        if self._quiet:
            return
        self.fill(self.settings())
        self._on_change()

    def _change_scenario(self, event: Any) -> None:
        if self._quiet:
            return
        self._quiet = True
        names = list(chain_tasks(event.new))
        self._tasks.param.update(options={name: name for name in names}, value=names)
        self._quiet = False
        self._changed()


def task_words(task: Task) -> str:
    """A task's name and the missiles that fly in it: `source-1 · 1 2 3`."""
    return f"{task.name} · {' '.join(map(str, task.missiles)) or 'no missile'}"


def _many(label: str, options: dict[str, str], most: int) -> pmui.MultiChoice:
    return pmui.MultiChoice(
        label=label, options=options, value=[], margin=0, max_items=most, solid=False,
        styles={"flex": "1 1 330px"},
    )  # fmt: skip


def _one(label: str, options: dict[str, str], flex: str) -> pmui.Select:
    return pmui.Select(label=label, options=options, size="small", margin=0, styles={"flex": flex})


def _number(label: str, low: int, high: int, width: int, words: str) -> NumberField:
    return NumberField(
        label=label, start=low, end=high, value=low, words=words, width=width, margin=0, sizing_mode="fixed"
    )
