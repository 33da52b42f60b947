"""What a run's metrics say about each of its stages: how long it took, and its held-out evaluations as a curve."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

MOST_POINTS: Final = 100
"""Points of one curve at most."""
POINTS_OF_A_FILE: Final = 3_200
"""Points of all curves of a file together, so that it stays small."""


@dataclass(frozen=True)
class StageRecord:
    """One stage of a run."""

    epochs: int
    env_steps: int
    wall_s: float
    cpu_s: float
    """Processor time; on a busy machine it says more about the work than the clock does [s]."""
    steps: tuple[int, ...]
    """Environment steps of the stage at each held-out evaluation."""
    success_rate: tuple[float, ...]
    mean_return: tuple[float, ...]


def stage_records(rows: Iterable[Mapping[str, Any]]) -> dict[str, StageRecord]:
    """Stages by the name of their task.

    Args:
        rows: metrics rows of a run, oldest first.
    """
    by_task: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        by_task.setdefault(str(row["task"]), []).append(row)
    return {task: _record(stage) for task, stage in by_task.items()}


def _record(rows: Sequence[Mapping[str, Any]]) -> StageRecord:
    last = rows[-1]
    held_out = [row for row in rows if row.get("success_rate") is not None and row.get("return_mean") is not None]
    return StageRecord(
        epochs=int(last["epoch"]),
        env_steps=int(last["env_steps"]),
        wall_s=round(float(last.get("wall_s") or 0.0), 1),
        cpu_s=round(float(last.get("cpu_s") or 0.0), 1),
        steps=tuple(int(row["env_steps"]) for row in held_out),
        success_rate=tuple(round(float(row["success_rate"]), 3) for row in held_out),
        mean_return=tuple(round(float(row["return_mean"])) for row in held_out),
    )


def points_per_curve(lengths: Sequence[int]) -> int:
    """How many points a curve may have in a file with curves of these lengths; short ones leave room for long ones."""
    for points in range(MOST_POINTS, 2, -1):
        if sum(min(length, points) for length in lengths) <= POINTS_OF_A_FILE:
            return points
    return 2


def thinned(record: StageRecord, points: int) -> StageRecord:
    """The same stage with at most so many points, first and last included, evenly spread."""
    rows = evenly(len(record.steps), points)
    kept = {
        name: tuple(getattr(record, name)[row] for row in rows) for name in ("steps", "success_rate", "mean_return")
    }
    return dataclasses.replace(record, **kept)


def evenly(length: int, points: int) -> list[int]:
    """Indices of at most so many of a curve's points, first and last included, evenly spread; all if they are few."""
    if length <= points:
        return list(range(length))
    return [int(row) for row in np.unique(np.linspace(0, length - 1, points).round())]
