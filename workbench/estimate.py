"""What trainings will cost: the most they can take and what they usually take, from speeds measured on this machine."""

from __future__ import annotations

import dataclasses
import heapq
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any, Literal

from workbench.launcher import cpu_count
from workbench.runs import Run

if TYPE_CHECKING:
    from agents.config import TrainingConfig

TYPICAL_EPOCH_S = {"paper": 30.0, "fast": 3.0, "smoke": 2.0}
"""Seconds per epoch on one core of a desktop machine, for whoever has no runs yet."""
RUNS_LOOKED_AT = 8
TAIL_BYTES = 8192
"""More than a row of metrics takes."""


@dataclass(frozen=True)
class Speed:
    """How long an epoch takes [s], and how that is known."""

    epoch_s: float
    source: Literal["runs", "probe", "typical"]
    runs: int = 0
    """Earlier runs it was measured in."""
    when: str = ""
    """When a probe measured it, for a person."""


@dataclass(frozen=True)
class Estimate:
    """Times until the last of a set of runs has ended."""

    at_most_s: float
    """With all epochs done [s]; a stage of the fast profile ends as soon as it is learned."""
    stages: int
    """Stages of the longest run."""
    at_once: int
    """Runs that work at the same time."""
    measured_runs: int
    """Earlier runs the speed was taken from; 0 where it is the typical one or a probe's for any of them."""
    likely_s: float | None = None
    """With as many epochs as such trainings took before [s]; None where nothing is known of one of them."""
    speeds: Mapping[tuple[str, str], Speed] | None = None
    """Speed by profile and learning algorithm."""


def estimate(config: TrainingConfig, seeds: int, runs: Sequence[Run]) -> Estimate:
    """The most that `seeds` trainings like this can take, given the earlier `runs` (newest first)."""
    return estimate_set([config] * seeds, runs)


def estimate_set(
    configs: Sequence[TrainingConfig], runs: Sequence[Run], probes: Mapping[str, Speed] | None = None
) -> Estimate:
    """What these trainings cost together.

    Args:
        configs: one per run, in the order of the queue.
        runs: earlier runs, newest first.
        probes: speeds of the guided learner by profile, where somebody has had them measured.
    """
    speeds: dict[tuple[str, str], Speed] = {}
    costs: dict[TrainingConfig, tuple[float, float | None]] = {}
    for config in configs:
        kind = kind_of(config)
        if kind not in speeds:
            speeds[kind] = speed_of(config, runs, probes or {})
        unseeded = _unseeded(config)
        if unseeded not in costs:
            epoch_s = speeds[kind].epoch_s
            most = len(config.stages) * config.hyperparameters.epochs * epoch_s
            costs[unseeded] = most, usual_s(config, runs, epoch_s)
    at_once = max(min(len(configs), cpu_count()), 1)
    spent = [costs[_unseeded(config)] for config in configs]
    usual = [likely for _, likely in spent if likely is not None]
    return Estimate(
        at_most_s=queue_s([most for most, _ in spent], at_once),
        stages=max(len(config.stages) for config in configs),
        at_once=at_once,
        measured_runs=min(speed.runs for speed in speeds.values()),
        likely_s=queue_s(usual, at_once) if len(usual) == len(spent) else None,
        speeds=speeds,
    )


def queue_s(durations_s: Sequence[float], at_once: int) -> float:
    """Time until all are done when each starts as soon as a core is free [s]."""
    cores = [0.0] * at_once
    for duration in durations_s:
        heapq.heapreplace(cores, cores[0] + duration)
    return max(cores)


def kind_of(config: TrainingConfig) -> tuple[str, str]:
    """Profile and learning algorithm: what the length of an epoch depends on."""
    from agents.config import VARIANTS

    return config.profile, VARIANTS[config.variant].algorithm


def speed_of(config: TrainingConfig, runs: Sequence[Run], probes: Mapping[str, Speed]) -> Speed:
    """How long an epoch takes: measured in earlier runs, else by a probe, else as on a typical machine."""
    measured = epoch_seconds(config, runs)
    if measured:
        return Speed(median(measured), "runs", len(measured))
    if config.profile in probes and kind_of(config)[1] == "td3":
        return probes[config.profile]
    return Speed(TYPICAL_EPOCH_S[config.profile], "typical")


def epoch_seconds(config: TrainingConfig, runs: Sequence[Run]) -> list[float]:
    """Seconds per epoch [s] of the newest runs with this profile and this learning algorithm."""
    wanted, speeds = kind_of(config), []
    for run in runs:
        if len(speeds) == RUNS_LOOKED_AT:
            break
        if run.problem or kind_of(run.config) != wanted:
            continue
        row = _last_row(run)
        if row.get("wall_s") and row.get("epoch"):
            speeds.append(row["wall_s"] / row["epoch"])
    return speeds


def usual_s(config: TrainingConfig, runs: Sequence[Run], epoch_s: float) -> float | None:
    """What a training like this took in earlier finished runs, or would take with the shipped policies' epochs [s].

    None where no such training is known: no run has finished, and what is shipped learned something else.
    """
    took = [
        run.state.wall_s
        for run in runs
        if not run.problem and run.state.state == "finished" and _unseeded(run.config) == _unseeded(config)
    ]
    if took:
        return median(took[:RUNS_LOOKED_AT])
    epochs = _shipped_epochs(config)
    return None if epochs is None else min(epochs, len(config.stages) * config.hyperparameters.epochs) * epoch_s


def _shipped_epochs(config: TrainingConfig) -> int | None:
    """Epochs after which the shipped policies of these stages were as good as they are."""
    from sim.scenario_file import load_scenario
    from workbench.policies import shipped_cards

    digest = load_scenario(config.scenario).digest
    cards = {tuple(card.missiles): card for card in shipped_cards().values() if card.scenario_digest == digest}
    found = [cards.get(missiles) for missiles in config.stages]
    alike = [card.epoch for card in found if card and (card.variant, card.profile) == (config.variant, config.profile)]
    return sum(alike) if len(alike) == len(found) else None


def _unseeded(config: TrainingConfig) -> TrainingConfig:
    return dataclasses.replace(config, seed=0, name="")


def _last_row(run: Run) -> dict[str, Any]:
    """The newest row of a run's metrics, read from the end of the file; empty while there is none."""
    try:
        with (run.path / "metrics.jsonl").open("rb") as file:
            file.seek(max(0, file.seek(0, os.SEEK_END) - TAIL_BYTES))
            row = json.loads(file.read().splitlines()[-1])
    except (OSError, IndexError, ValueError):
        return {}
    return row if isinstance(row, dict) else {}
