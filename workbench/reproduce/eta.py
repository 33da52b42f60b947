"""How long a reproduction will still take, from the speed of earlier runs on this machine."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from agents.config import TrainingConfig
from workbench.estimate import estimate
from workbench.runs import Run

TYPICAL_EVALUATION_S = 8.0
"""1000 episodes of a network policy on one core of a desktop machine, for whoever has flown none yet."""


def left_s(trainings_s: Sequence[float], at_once: int, evaluations_s: float) -> float:
    """Time until all is done, with so many trainings at once [s].

    No core idles, but no training is shared; policies are evaluated while others train.

    Args:
        trainings_s: what every training that has not ended still needs.
        at_once: trainings that run side by side.
        evaluations_s: what all evaluations take that have not been made yet.
    """
    shared = sum(trainings_s) / max(at_once, 1)
    return max(shared, *trainings_s, evaluations_s, 0.0)


def training_s(config: TrainingConfig, runs: Sequence[Run]) -> float:
    """Time a training like this took in these earlier runs (newest first), or at most takes if there is none [s]."""
    alike = [
        run.state.wall_s
        for run in runs
        if not run.problem and run.state.state == "finished" and _kind(run.config) == _kind(config)
    ]
    return median(alike[:10]) if alike else estimate(config, 1, runs).at_most_s


def _kind(config: TrainingConfig) -> tuple[str, str, bool, int]:
    return config.variant, config.profile, config.curriculum, config.missiles
