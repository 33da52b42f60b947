"""What a scenario must reproduce of the paper, measured: the two calibration tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from agents.calibration_target import LeftOut, Target, mean_interval
from agents.drag_rules import DragRule, LoiterExpert, edge_of, rule_family
from agents.evaluation import EpisodeResults, evaluate, wilson_interval
from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy
from agents.policy import Policy
from agents.task import BoolArray
from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Outcome

SEED = 7
WINNABLE_STATES = 200
FIXED_ANGLES_DEG = (90, 100, 110, 120, 130, 140, 150, 160, 170, 180)
SUCCESSFUL_LENGTH_S = (850.0, 1000.0)
"""Inferred from the returns of Table 4: 400 + 4 x 50 - 0.1 per second."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Calibration:
    """The lines of the calibration tables for one scenario."""

    scenario: str
    episodes: int
    seed: int
    targets: tuple[Target, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def ok(self) -> bool:
        """Whether every measured value is accepted."""
        return all(target.ok for target in self.targets)

    @property
    def missed(self) -> bool:
        """Whether a line is missed for sure, its whole interval outside of what is accepted."""
        return any(target.verdict == "not ok" for target in self.targets)

    @property
    def shortfall(self) -> float:
        """How far the values are from all targets, summed over the lines: 0 exactly when all are ok.

        A share counts with the points it lies outside, 0.01 each; other values in the scale of their line.
        """
        return sum(target.shortfall for target in self.targets)

    @property
    def doubt(self) -> float:
        """How far the 95 % intervals reach out of what is accepted, summed over the lines."""
        return sum(target.doubt for target in self.targets)

    def to_json(self) -> dict[str, Any]:
        """The tables as plain JSON values."""
        lines = {"targets": [t.to_json() for t in self.targets], "left_out": [line.to_json() for line in self.left_out]}
        return {"scenario": self.scenario, "episodes": self.episodes, "seed": self.seed,
                "shortfall": self.shortfall, **lines}  # fmt: skip


class Bench:
    """Flies policies on the tasks of a scenario, from the same initial states, and remembers what it has flown.

    Args:
        scenario: its task without masks is the target task.
        episodes: engagements per policy and task.
        seed: seed of the initial states.
        winnable_states: initial states for which a plan that gets through is looked for.
        progress: told how many flights of how many are done.
    """

    def __init__(
        self, scenario: Scenario, episodes: int, seed: int, winnable_states: int, progress: Progress | None = None
    ) -> None:
        self.scenario, self.episodes, self.seed, self.winnable_states = scenario, episodes, seed, winnable_states
        self.missiles = scenario.launch.missiles
        self.family = rule_family(scenario.battlefield.width_m)
        self._progress, self._flown, self._done = progress, dict[tuple[str, int], EpisodeResults](), 0
        navigation = len({0, 1, self.missiles})
        self._total = 2 * self.missiles + 2 + navigation + 1 + len(FIXED_ANGLES_DEG) + len(self.family)

    def fly(self, policy: Policy, missiles: int, episodes: int | None = None) -> EpisodeResults:
        """A policy on the task with missiles 1 to `missiles`; flown once, however often it is asked for."""
        key = (policy.name, missiles)
        if key not in self._flown:
            task = Task(self.scenario).mask(range(missiles + 1, self.missiles + 1))
            results = evaluate(policy, task, episodes or self.episodes, self.seed).results
            assert results is not None
            self._flown[key] = results
        self.count(1)
        return self._flown[key]

    def count(self, flights: int) -> None:
        """Report flights as done."""
        self._done += flights
        if self._progress is not None and flights:
            self._progress(self._done, self._total)


Line = Target | LeftOut
Lines = Callable[[Bench], Iterator[Line]]


def calibrate(
    episodes: int, progress: Progress | None = None, scenario: Scenario | None = None, seed: int = SEED
) -> Calibration:
    """Measure every line with `episodes` engagements each (200 for the winnable share).

    Args:
        episodes: engagements per policy and task.
        progress: told how many flights are done.
        scenario: the default scenario unless another is given.
        seed: seed of the initial states.
    """
    return measure(Bench(scenario or load_scenario(), episodes, seed, WINNABLE_STATES, progress), ALL_LINES)


def measure(bench: Bench, groups: Sequence[Lines], *, give_up: bool = False) -> Calibration:
    """Measure groups of lines one after the other; with `give_up` no further ones after a line missed for sure."""
    lines: list[Line] = []
    for group in groups:
        lines += group(bench)
        if give_up and any(isinstance(line, Target) and line.verdict == "not ok" for line in lines):
            break
    targets = tuple(line for line in lines if isinstance(line, Target))
    left_out = tuple(line for line in lines if isinstance(line, LeftOut))
    return Calibration(bench.scenario.name, bench.episodes, bench.seed, targets, left_out)


def dragging_on_target(bench: Bench) -> Iterator[Line]:
    """The dragging expert on the target task: how often it gets through (Fig. 13), and in what time."""
    results, rules = bench.fly(DraggingExpert(), bench.missiles), bench.scenario.rules
    yield _share(f"dragging expert, {_missiles(bench.missiles)}", results.success, 0.59, 0.65)
    name = f"length of the expert's successful flights, {_missiles(bench.missiles)} [s]"
    low, high = SUCCESSFUL_LENGTH_S
    if rules.max_steps * rules.step_s < low:
        yield LeftOut(name, f"an episode ends after {rules.max_steps * rules.step_s:g} s")
        return
    length_s = results.steps[results.success] * rules.step_s
    value = float(length_s.mean()) if len(length_s) else math.nan
    yield Target(name, value, low, high, mean_interval(length_s), scale=high - low)


def ladder(bench: Bench) -> Iterator[Line]:
    """The dragging expert on the tasks with fewer missiles: graded, and easy at the end."""
    success = [bench.fly(DraggingExpert(), missiles).success for missiles in range(bench.missiles + 1)]
    for n in range(bench.missiles - 1, 1, -1):
        name = f"dragging expert, {n} missiles (at least as with {n + 1})"
        yield _share(name, success[n], float(success[n + 1].mean()), 1.0)
    if bench.missiles == 1:
        yield LeftOut("dragging expert, 1 missile, at least 95 %", "one missile is the target task here")
    else:
        yield _share("dragging expert, 1 missile", success[1], max(0.95, float(success[2].mean())), 1.0)
    yield _share("dragging expert, no missile", success[0], 0.99, 1.0)
    name = "largest step between neighbours of this ladder"
    if bench.missiles < 3:
        yield LeftOut(name, "fewer than three missiles cannot lead from 95 to 65 % in steps of 25 points")
        return
    # Both tasks start from the same states: the step is a mean of differences, episode by episode.
    steps = [success[n].astype(float) - success[n + 1] for n in range(bench.missiles)]
    largest = max(steps, key=np.mean)
    yield Target(name, float(largest.mean()), 0.0, 0.25, mean_interval(largest))


def navigation(bench: Bench) -> Iterator[Line]:
    """The navigation expert ignores missiles: it arrives without them and must not with them."""
    yield _share("navigation expert, no missile", bench.fly(NavigationExpert(), 0).success, 0.99, 1.0)
    if bench.missiles == 1:
        yield LeftOut("navigation expert, 1 missile, at most 30 %", "one missile is the target task here")
    else:
        yield _share("navigation expert, 1 missile", bench.fly(NavigationExpert(), 1).success, 0.0, 0.30)
    success = bench.fly(NavigationExpert(), bench.missiles).success
    yield _share("navigation expert, target task", success, 0.0, 0.05)


def fixed_angles(bench: Bench) -> Iterator[Line]:
    """Were one constant angle enough, nothing would have to be learned about several missiles."""
    success = [bench.fly(DraggingExpert(math.radians(a)), bench.missiles).success for a in FIXED_ANGLES_DEG]
    yield _share("best fixed-angle drag, 90 to 180 degrees", max(success, key=np.mean), 0.0, 0.90)


def chance(bench: Bench) -> Iterator[Line]:
    """The random policy on every task with missiles."""
    success = [bench.fly(RandomPolicy(), missiles).success for missiles in range(1, bench.missiles + 1)]
    yield _share("random policy, best of the tasks with missiles", max(success, key=np.mean), 0.0, 0.01)


def loitering(bench: Bench) -> Iterator[Line]:
    """Evading every missile and never leaving: 4 x 50 - 1200 x 0.1 = 80 in the paper, its local optimum."""
    reward = bench.scenario.reward
    paid = round(bench.missiles * reward.evaded + bench.scenario.rules.max_steps * reward.step, 2)
    rule = DragRule(math.radians(105), "centre", edge_of(bench.scenario.battlefield.width_m))
    results = bench.fly(LoiterExpert(rule), bench.missiles)
    loitered = (results.solved == bench.missiles) & (results.outcome == Outcome.TIMEOUT)
    returns = np.round(results.episode_return[loitered].astype(np.float64), 2)
    name = "return of evading every missile and loitering"
    value = float(returns.mean()) if len(returns) else math.nan  # NaN, accepted nowhere: nobody loitered
    # Nothing in it is left to chance: where all agree, the value is exact.
    agreed = len(returns) > 0 and np.ptp(returns) == 0.0
    yield Target(name, value, paid, paid, (value, value) if agreed else mean_interval(returns), scale=100.0)


def winnable(bench: Bench) -> Iterator[Line]:
    """The share of initial states from which some plan of a family of rules gets through."""
    won = np.zeros(bench.winnable_states, dtype=bool)
    for flown, rule in enumerate(bench.family):
        if won.all():
            bench.count(len(bench.family) - flown)
            break
        won |= bench.fly(rule, bench.missiles, bench.winnable_states).success
    yield _share(f"winnable by some plan, of {bench.winnable_states} initial states", won, 0.98, 1.0)


QUICK_LINES: Final[Sequence[Lines]] = (dragging_on_target, ladder, navigation, fixed_angles)
"""Lines that sort scenarios fast, the most telling first."""
ALL_LINES: Final[Sequence[Lines]] = (*QUICK_LINES, chance, loitering, winnable)


def _share(name: str, happened: BoolArray, low: float, high: float) -> Target:
    value = float(happened.mean())
    return Target(name, value, low, high, wilson_interval(int(happened.sum()), len(happened)))


def _missiles(count: int) -> str:
    return f"{count} missile{'' if count == 1 else 's'}"
