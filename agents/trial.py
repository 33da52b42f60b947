"""One trial of the study of stability: the target's stage, trained without one remedy, and how steadily it learned."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from agents.checkpoint import PolicyCard
from agents.config import TrainingConfig
from agents.hyperparameters import ConfigError, Hyperparameters
from agents.policy import NetworkPolicy, Policy
from agents.recorder import NoRecorder
from agents.remedies import REMEDIES
from agents.submas import train
from agents.task import Domain

ARRIVED: Final = 0.95
"""Held-out success from which on a policy counts as having learned its task."""
LATE: Final = 5
"""Evaluations at the end of a trial, when the guide is gone, whose mean says where it settled."""

Progress = Callable[[int, int], None]
"""Called with (epochs done, epochs in all)."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What one trial has shown; T held-out evaluations."""

    remedy: str
    """Key of `REMEDIES`."""
    seed: int
    guide: str
    epochs: tuple[int, ...]
    """Epoch of each evaluation."""
    success_rate: tuple[float, ...]
    mean_return: tuple[float, ...]
    epsilon: tuple[float, ...]
    """How much of the guide was left."""
    final_success_rate: float
    """Of the best policy, on fresh episodes."""
    cpu_s: float
    """Processor time [s]."""

    def __post_init__(self) -> None:
        """A trial without an evaluation says nothing."""
        if not self.epochs or not len(self.epochs) == len(self.success_rate) == len(self.mean_return):
            raise ValueError(f"trial {self.remedy} seed {self.seed} has no evaluations, or not one of each per epoch")

    @property
    def arrived(self) -> int | None:
        """First epoch with a held-out success of at least `ARRIVED`; None if there was none."""
        return next((e for e, rate in zip(self.epochs, self.success_rate, strict=True) if rate >= ARRIVED), None)

    @property
    def worst_fall(self) -> float:
        """Largest loss of success against the best evaluation before, in [0, 1]."""
        rates = np.array(self.success_rate)
        return float((np.maximum.accumulate(rates) - rates).max())

    @property
    def late_success(self) -> float:
        """Mean success of the last `LATE` evaluations."""
        return float(np.mean(self.success_rate[-LATE:]))

    def to_json(self) -> dict[str, Any]:
        """All fields as plain JSON values."""
        return dataclasses.asdict(self)


class _Listener(NoRecorder):
    """Keeps the rows with a held-out evaluation, and the judgement of the best policy."""

    def __init__(self, progress: Progress) -> None:
        self.rows: list[dict[str, Any]] = []
        self.final = 0.0
        self._progress = progress

    def epoch(self, row: dict[str, Any]) -> None:
        if row["success_rate"] is not None:
            self.rows.append(row)
        self._progress(row["epoch"], row["epochs"])

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        if card.final and card.evaluation is not None:
            self.final = float(card.evaluation["success_rate"])


def run_trial(
    remedy: str,
    seed: int,
    guide: Policy,
    progress: Progress,
    *,
    config: TrainingConfig | None = None,
    domain: Domain | None = None,
    hyperparameters: Hyperparameters | None = None,
) -> Trial:
    """Train the target's stage without one remedy.

    Args:
        remedy: key of `REMEDIES`.
        seed: seed of networks, exploration and initial states.
        guide: policy of the next easier task.
        progress: told about every epoch.
        config: what to train; the default scenario's target task.
        domain: where tasks come from; the paper's domain by default.
        hyperparameters: numbers to use instead of the remedy's.

    Raises:
        ConfigError: there is no such remedy.
    """
    if remedy not in REMEDIES:
        raise ConfigError(f"remedy '{remedy}' is unknown; known are {', '.join(REMEDIES)}")
    config = dataclasses.replace(config or TrainingConfig(), seed=seed)
    listener, began_s = _Listener(progress), time.process_time()
    numbers = hyperparameters or REMEDIES[remedy].hyperparameters
    train(config, listener, guide, domain=domain, hyperparameters=numbers)
    return Trial(
        remedy=remedy,
        seed=seed,
        guide=guide.name,
        epochs=tuple(int(row["epoch"]) for row in listener.rows),
        success_rate=tuple(round(float(row["success_rate"]), 4) for row in listener.rows),
        mean_return=tuple(round(float(row["return_mean"]), 1) for row in listener.rows),
        epsilon=tuple(round(float(row["epsilon"]), 3) for row in listener.rows),
        final_success_rate=listener.final,
        cpu_s=round(time.process_time() - began_s, 1),
    )
