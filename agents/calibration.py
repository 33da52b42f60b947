"""What the default scenario must reproduce of the paper, measured: the two calibration tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from agents.drag_rules import DragRule, LoiterExpert, edge_of, rule_family
from agents.evaluation import Evaluation, evaluate
from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy
from agents.policy import Policy
from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Outcome

SEED = 7
WINNABLE_STATES = 200
FIXED_ANGLES_DEG = (90, 100, 110, 120, 130, 140, 150, 160, 170, 180)

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Target:
    """One line of a calibration table: a measured value and the interval it must lie in."""

    name: str
    value: float
    low: float
    high: float

    @property
    def ok(self) -> bool:
        """Whether the value lies in the interval."""
        return self.low <= self.value <= self.high

    def to_json(self) -> dict[str, str | float | bool]:
        """The line as plain JSON values."""
        return {"name": self.name, "value": self.value, "low": self.low, "high": self.high, "ok": self.ok}


def calibrate(episodes: int, progress: Progress | None = None, scenario: Scenario | None = None) -> list[Target]:
    """Measure every line with `episodes` engagements each (200 for the winnable share), from seed 7.

    Args:
        episodes: engagements per policy and task.
        progress: told how many measurements are done.
        scenario: the default scenario unless another is given.
    """
    bench = _Bench(scenario or load_scenario(), episodes, progress)
    return [*_ladder(bench), *_simple_policies(bench), *_loiter(bench), *_interest(bench)]


class _Bench:
    """Flies policies on the tasks of Table 1 and counts what is done."""

    def __init__(self, scenario: Scenario, episodes: int, progress: Progress | None) -> None:
        self.scenario, self.episodes, self._progress = scenario, episodes, progress
        self.missiles = scenario.launch.missiles
        self.family = rule_family(scenario.battlefield.width_m)
        self._done = 0
        self._total = 2 * self.missiles + 4 + 1 + len(FIXED_ANGLES_DEG) + len(self.family)

    def fly(self, policy: Policy, missiles: int, episodes: int | None = None) -> Evaluation:
        target = Task(self.scenario)
        task = target.mask(range(missiles + 1, self.missiles + 1))
        evaluation = evaluate(policy, task, episodes or self.episodes, SEED)
        self._done += 1
        if self._progress is not None:
            self._progress(self._done, self._total)
        return evaluation


def _ladder(bench: _Bench) -> Iterator[Target]:
    flown = [bench.fly(DraggingExpert(), n) for n in range(bench.missiles + 1)]
    rates = [evaluation.success_rate for evaluation in flown]
    yield Target(f"dragging expert, {bench.missiles} missiles", rates[-1], 0.59, 0.65)
    for n in range(bench.missiles - 1, 1, -1):
        yield Target(f"dragging expert, {n} missiles (at least as with {n + 1})", rates[n], rates[n + 1], 1.0)
    yield Target("dragging expert, 1 missile", rates[1], max(0.95, rates[2]), 1.0)
    yield Target("dragging expert, no missile", rates[0], 0.99, 1.0)
    yield Target("largest step between neighbours of this ladder", float(-np.diff(rates).min()), 0.0, 0.25)
    yield Target(
        "length of the expert's successful flights, 4 missiles [s]",
        _successful_length(flown[-1]),
        850.0,
        1000.0,
    )


def _simple_policies(bench: _Bench) -> Iterator[Target]:
    navigation = NavigationExpert()
    yield Target("navigation expert, no missile", bench.fly(navigation, 0).success_rate, 0.99, 1.0)
    yield Target("navigation expert, 1 missile", bench.fly(navigation, 1).success_rate, 0.0, 0.30)
    yield Target("navigation expert, target task", bench.fly(navigation, bench.missiles).success_rate, 0.0, 0.05)
    rates = [bench.fly(RandomPolicy(), n).success_rate for n in range(1, bench.missiles + 1)]
    yield Target("random policy, best of the tasks with missiles", max(rates), 0.0, 0.01)


def _loiter(bench: _Bench) -> Iterator[Target]:
    rule = DragRule(math.radians(105), "centre", edge_of(bench.scenario.battlefield.width_m))
    results = bench.fly(LoiterExpert(rule), bench.missiles).results
    assert results is not None
    loitered = (results.solved == bench.missiles) & (results.outcome == Outcome.TIMEOUT)
    returns = np.round(results.episode_return[loitered], 2)
    # NaN, which lies in no interval, when nobody loitered: then the number was not shown.
    value = float(returns.mean(dtype=np.float64)) if len(returns) and np.ptp(returns) == 0 else math.nan
    yield Target("return of evading every missile and loitering", round(value, 2), 80.0, 80.0)


def _interest(bench: _Bench) -> Iterator[Target]:
    fixed = [bench.fly(DraggingExpert(math.radians(a)), bench.missiles).success_rate for a in FIXED_ANGLES_DEG]
    yield Target("best fixed-angle drag, 90 to 180 degrees", max(fixed), 0.0, 0.90)
    won = np.zeros(WINNABLE_STATES, dtype=bool)
    for rule in bench.family:
        results = bench.fly(rule, bench.missiles, WINNABLE_STATES).results
        assert results is not None
        won |= results.success
    yield Target(f"winnable by some plan, of {WINNABLE_STATES} initial states", float(won.mean()), 0.98, 1.0)


def _successful_length(evaluation: Evaluation) -> float:
    results = evaluation.results
    assert results is not None
    return float(results.steps[results.success].mean()) if results.success.any() else math.nan
