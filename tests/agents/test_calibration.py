"""The default scenario reproduces the paper's figures, and the tables would say so if it did not."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from agents import calibration, calibration_bench
from agents.calibration import ALL_LINES, SEED, Lines, calibrate, dragging_on_target, measure
from agents.calibration_bench import Bench
from agents.calibration_table import Calibration, LeftOut, Target
from agents.drag_rules import rule_family
from agents.evaluation import evaluate
from agents.expert import DraggingExpert
from sim.scenario_file import load_scenario
from sim.task import Task
from tests.engagements import DRILL, changed

DEFAULT = load_scenario()
SHORT = changed(rules={"max_steps": 60})
"""The drill, over before anybody arrives: for tests of which lines there are."""


@pytest.fixture
def few_plans(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer angles, rules and states: a table in seconds."""
    monkeypatch.setattr(calibration, "FIXED_ANGLES_DEG", (90, 120))
    monkeypatch.setattr(calibration, "rule_family", lambda width_m: rule_family(width_m)[:3])
    monkeypatch.setattr(calibration, "WINNABLE_STATES", 20)


def named(measured: Calibration) -> dict[str, Target]:
    """The lines of a table by their names."""
    assert len({target.name for target in measured.targets}) == len(measured.targets)
    return {target.name: target for target in measured.targets}


def test_the_dragging_expert_succeeds_as_often_as_in_the_paper() -> None:
    """Fig. 13: 62.1 % on the target task."""
    evaluation = evaluate(DraggingExpert(), Task(DEFAULT), 1000, SEED)
    assert 0.59 <= evaluation.success_rate <= 0.65


@pytest.mark.usefixtures("few_plans")
def test_the_tables_hold_fourteen_lines_and_progress_ends_at_its_total() -> None:
    seen: list[tuple[int, int]] = []
    measured = calibrate(20, lambda done, total: seen.append((done, total)))
    assert len(measured.targets) == 14
    assert not measured.left_out
    assert seen[-1][0] == seen[-1][1]
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    # What does not depend on luck holds even with twenty engagements.
    sure = named(measured)
    for name in ("dragging expert, no missile", "navigation expert, no missile", "navigation expert, target task"):
        assert sure[name].ok
    assert sure["return of evading every missile and loitering"].value == 80.0
    assert sure["return of evading every missile and loitering"].verdict == "ok"


def test_another_scenario_misses_its_targets() -> None:
    """Negative control: with a third of the launch range left, nearly every missile hits."""
    launch = dataclasses.replace(DEFAULT.launch, range_m=DEFAULT.launch.range_m / 3)
    task = Task(dataclasses.replace(DEFAULT, launch=launch))
    assert evaluate(DraggingExpert(), task, 300, SEED).success_rate < 0.5


def test_values_and_intervals_are_those_of_the_evaluator() -> None:
    bench = Bench(DRILL, 60, 3, 5)
    share = next(line for line in dragging_on_target(bench) if isinstance(line, Target))
    evaluation = evaluate(DraggingExpert(), Task(DRILL), 60, 3)
    assert (share.value, share.ci95) == (evaluation.success_rate, evaluation.success_ci95)


@pytest.mark.usefixtures("few_plans")
@pytest.mark.parametrize(("missiles", "lines", "left_out"), [(1, 8, 4), (2, 10, 2), (3, 12, 1), (4, 13, 1), (8, 17, 1)])
def test_the_tables_are_stated_for_the_scenarios_own_number_of_missiles(
    missiles: int, lines: int, left_out: int
) -> None:
    scenario = changed(SHORT, launch={"missiles": missiles})
    seen: list[tuple[int, int]] = []
    measured = calibrate(4, lambda done, total: seen.append((done, total)), scenario)
    # Left out are the length (60 s end every flight) and, below three missiles, what contradicts the other lines.
    assert (len(measured.targets), len(measured.left_out)) == (lines, left_out)
    assert seen[-1][0] == seen[-1][1]
    plural = "s" if missiles > 1 else ""
    loiter = named(measured)["return of evading every missile and loitering"]
    assert f"dragging expert, {missiles} missile{plural}" in named(measured)
    assert loiter.low == loiter.high == 50.0 * missiles - 6.0
    assert all(len(line.reason) > 20 for line in measured.left_out)


def test_a_flight_takes_seconds_not_steps() -> None:
    """Half-second steps: twice as many of them, the same time."""

    def length_s(step_s: float, max_steps: int) -> Target:
        bench = Bench(changed(DEFAULT, rules={"step_s": step_s, "max_steps": max_steps, "substeps": 10}), 12, 3, 5)
        return [line for line in dragging_on_target(bench) if isinstance(line, Target)][1]

    whole, half = length_s(1.0, 1200), length_s(0.5, 2400)
    assert half.value == pytest.approx(whole.value, rel=0.1)


def test_giving_up_spares_what_comes_after_a_line_that_is_surely_missed() -> None:
    called: list[str] = []

    def group(name: str, value: float) -> Lines:
        def lines(_: Bench) -> list[Target | LeftOut]:
            called.append(name)
            return [Target(name, value, 0.0, 0.3, (value - 0.1, value + 0.1)), LeftOut(f"no {name}", "of no use")]

        return lines  # type: ignore[return-value]

    groups = [group("a", 0.1), group("b", 0.35), group("c", 0.5), group("d", 0.1)]
    bench = Bench(DRILL, 1, 3, 1)
    assert [target.name for target in measure(bench, groups, give_up=True).targets] == ["a", "b", "c"]
    assert called == ["a", "b", "c"]
    assert [target.name for target in measure(bench, groups).targets] == ["a", "b", "c", "d"]


def test_a_flight_is_flown_once_however_often_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    flown: list[tuple[str, int]] = []

    def counted(policy: DraggingExpert, task: Task, *rest: Any) -> object:
        flown.append((policy.name, len(task.missiles)))
        return evaluate(policy, task, *rest)

    monkeypatch.setattr(calibration_bench, "evaluate", counted)
    measure(Bench(SHORT, 4, 3, 4), ALL_LINES)
    assert len(flown) == len(set(flown))


@pytest.mark.usefixtures("few_plans")
def test_winnable_are_the_states_from_which_any_plan_gets_through() -> None:
    bench = Bench(changed(DRILL, launch={"range_m": 40e3}), 1, 3, 30)
    (line,) = calibration.winnable(bench)
    assert isinstance(line, Target)
    task = Task(bench.scenario)
    won = [evaluate(rule, task, 30, 3).results.success for rule in calibration.rule_family(50e3)]  # type: ignore[union-attr]
    assert 0.0 < won[0].mean() < line.value < 1.0
    assert line.value == np.any(won, axis=0).mean()


def test_the_largest_step_is_the_largest_difference_of_neighbours() -> None:
    bench = Bench(DRILL, 40, 3, 5)
    lines = {line.name: line for line in calibration.ladder(bench)}
    rates = [bench.fly(DraggingExpert(), missiles).success.mean() for missiles in range(5)]
    step = lines["largest step between neighbours of this ladder"]
    assert isinstance(step, Target)
    assert step.value == pytest.approx(-np.diff(rates).min())
    assert step.ci95[0] <= step.value <= step.ci95[1]


def test_where_nobody_arrives_there_is_no_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration, "SUCCESSFUL_LENGTH_S", (50.0, 1000.0))
    share, length = dragging_on_target(Bench(SHORT, 4, 3, 4))
    assert isinstance(share, Target)
    assert isinstance(length, Target)
    assert share.value == 0.0
    assert math.isnan(length.value)
    assert length.verdict == "not ok"
