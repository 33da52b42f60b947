"""The two flights of the Fly page."""

from __future__ import annotations

from sim.scenario_file import load_scenario
from sim.task import Task
from sim.trajectory import Trajectory, fly
from workbench.pages.fly_settings import FlySettings
from workbench.policies import resolve_policy
from workbench.runs import RunStore

SCENARIO = "default"
RECORD_EVERY = 2
"""Substeps between records: ten a second are more than a screen shows."""


def fly_both(settings: FlySettings, store: RunStore) -> tuple[Trajectory, Trajectory]:
    """Fly both policies from the same initial state.

    Raises:
        SubMasError: a policy does not exist any more, is damaged, or cannot see a missile of the task.
    """
    from agents.policy import bind

    task = Task(load_scenario(SCENARIO), settings.masked)
    bound = [bind(resolve_policy(spec, store), task) for spec in (settings.a, settings.b)]
    a, b = (
        fly(task, act, spec, settings.seed, record_every=RECORD_EVERY)
        for act, spec in zip(bound, (settings.a, settings.b), strict=True)
    )
    return a, b
