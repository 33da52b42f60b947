"""Where a scenario is calibrated: policies flown on its tasks, always from the same initial states."""

from __future__ import annotations

from collections.abc import Callable

from agents.episodes import EpisodeResults
from agents.evaluation import evaluate
from agents.evasion import EVASION
from agents.policy import Policy, bind
from agents.task import BoolArray, IntArray
from sim.scenario import Scenario
from sim.task import Task
from sim.world import Outcome


class Bench:
    """Flies policies on the tasks of a scenario and remembers what it has flown.

    Args:
        scenario: its task without masks is the target task.
        episodes: engagements per policy and task.
        seed: seed of the initial states.
        winnable_states: initial states for which a plan that gets through is looked for.
        told: called after every flight with the number of flights that are done.
    """

    def __init__(
        self,
        scenario: Scenario,
        episodes: int,
        seed: int,
        winnable_states: int,
        told: Callable[[int], None] | None = None,
    ) -> None:
        self.scenario, self.episodes, self.seed, self.winnable_states = scenario, episodes, seed, winnable_states
        self.missiles = scenario.launch.missiles
        self._told, self._flown, self._done = told, dict[tuple[str, int], EpisodeResults](), 0

    def fly(self, policy: Policy, missiles: int) -> EpisodeResults:
        """A policy on the task with missiles 1 to `missiles`; flown once, however often it is asked for."""
        key = (policy.name, missiles)
        if key not in self._flown:
            task = Task(self.scenario).mask(range(missiles + 1, self.missiles + 1))
            results = evaluate(policy, task, self.episodes, self.seed).results
            assert results is not None
            self._flown[key] = results
        self.count(1)
        return self._flown[key]

    def gets_through(self, policy: Policy, episodes: IntArray) -> BoolArray:
        """Whether a policy gets through the target task from each of these initial states `[N]`."""
        task = Task(self.scenario)
        act, world = bind(policy, task), EVASION.world(task, len(episodes), self.seed)
        observation = world.reset(episodes=episodes)
        while (world.outcome == Outcome.FLYING).any():
            observation = world.step(act(observation)).observation
        self.count(1)
        return world.outcome == Outcome.EXIT

    def count(self, flights: int) -> None:
        """Report flights as done."""
        self._done += flights
        if self._told is not None:
            self._told(self._done)
