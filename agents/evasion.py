"""The paper's domain (§2.3) as the learner sees it: missiles are subtasks, the exit is the final goal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from agents.features import ObservationFeatures
from agents.hyperparameters import ConfigError
from sim.observation import UNLAUNCHED, ObservationLayout
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Outcome, World

LENGTH_SCALES_M: Final = {"x": 1e5, "y": 1e5, "l": 1e5, "r": 5e4}
"""Divisors of positions and ranges [m]: fixed constants of about half a battlefield and a missile's reach."""


class EvasionDomain:
    """A `Domain`: an evader, an interceptor and its missiles."""

    action_limit: float = math.pi / 2
    default_block: tuple[float, ...] = UNLAUNCHED
    outcome_names: Mapping[int, str] = {
        int(Outcome.EXIT): "exit",
        int(Outcome.SHOT_DOWN): "shot_down",
        int(Outcome.LEFT_FIELD): "left_field",
        int(Outcome.TIMEOUT): "timeout",
        int(Outcome.NOT_FINITE): "not_finite",
    }

    def layout(self, subtasks: tuple[int, ...]) -> ObservationLayout:
        """Columns of a task with these missiles (Table 1)."""
        return ObservationLayout(subtasks)

    def target(self, scenario: str, subtasks: int) -> Task:
        """The engagement of a scenario with missiles 1 … n.

        Raises:
            ConfigError: the scenario has fewer missiles.
            ScenarioError: there is no such scenario.
        """
        task = Task(load_scenario(scenario))
        if subtasks > len(task.missiles):
            raise ConfigError(f"missiles is {subtasks}; legal with scenario '{scenario}' is 1 to {len(task.missiles)}")
        return task.mask(missile for missile in task.missiles if missile > subtasks)

    def subtasks(self, task: Task) -> tuple[int, ...]:
        """Unmasked missiles, ascending."""
        return task.missiles

    def masked(self, task: Task) -> tuple[int, ...]:
        """Masked missiles, ascending."""
        return tuple(sorted(task.masked))

    def scenario(self, task: Task) -> tuple[str, str]:
        """Name and digest of the scenario."""
        return task.scenario.name, task.scenario.digest

    def step_s(self, task: Task) -> float:
        """Length of a decision step [s]."""
        return task.scenario.rules.step_s

    def world(self, task: Task, lanes: int, seed: int) -> World:
        """Lanes of this engagement on the CPU."""
        return World(task, lanes, seed)

    def features(self, layout: ObservationLayout) -> ObservationFeatures:
        """Features of an observation of Table 1."""
        return ObservationFeatures(layout, layout.missiles, LENGTH_SCALES_M, UNLAUNCHED)


EVASION: Final = EvasionDomain()
"""The one instance; it has no state."""
