"""What a training will cost: the most it can take, from the speed of earlier runs on this machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from workbench.launcher import cpu_count
from workbench.run_files import RunFileError
from workbench.runs import Run

if TYPE_CHECKING:
    from agents.config import TrainingConfig

TYPICAL_EPOCH_S = {"paper": 30.0, "fast": 3.0, "smoke": 2.0}
"""Seconds per epoch on one core of a desktop machine, for whoever has no runs yet."""
RUNS_LOOKED_AT = 8


@dataclass(frozen=True)
class Estimate:
    """An upper bound: a stage of the fast profile ends as soon as it is learned."""

    at_most_s: float
    """Time until the last run has done all its epochs [s]."""
    stages: int
    """Stages of each run."""
    at_once: int
    """Runs that work at the same time."""
    measured_runs: int
    """Earlier runs the speed was taken from; 0 for the typical one."""


def estimate(config: TrainingConfig, seeds: int, runs: Sequence[Run]) -> Estimate:
    """The most that `seeds` trainings like this can take, given the earlier `runs` (newest first)."""
    speeds = epoch_seconds(config, runs)
    epoch_s = median(speeds) if speeds else TYPICAL_EPOCH_S[config.profile]
    stages = len(config.stages)
    at_once = min(seeds, cpu_count())
    rounds = math.ceil(seeds / at_once)
    return Estimate(rounds * stages * config.hyperparameters.epochs * epoch_s, stages, at_once, len(speeds))


def epoch_seconds(config: TrainingConfig, runs: Sequence[Run]) -> list[float]:
    """Seconds per epoch [s] of the newest runs with this profile and this learning algorithm."""
    from agents.config import VARIANTS

    wanted = config.profile, VARIANTS[config.variant].algorithm
    speeds: list[float] = []
    for run in runs:
        if run.problem or (run.config.profile, VARIANTS[run.config.variant].algorithm) != wanted:
            continue
        try:
            rows = run.metrics()
        except RunFileError:
            continue
        if rows and rows[-1].get("wall_s") and len(speeds) < RUNS_LOOKED_AT:
            speeds.append(rows[-1]["wall_s"] / rows[-1]["epoch"])
    return speeds
