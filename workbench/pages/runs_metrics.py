"""What runs have measured, as curves to lay over each other; read once and kept until the file changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from agents.statistics import bootstrap
from layouts.chart import thin_index
from layouts.run_curves import RunCurve, positions, smoothed
from workbench.pages.runs_settings import METRICS
from workbench.run_files import LineReader, RunFileError, Signature, signature

Values = NDArray[np.float64]

MOST_POINTS = 500
GRID = 150
"""Points of a group's curve."""
REPLICATES = 300
COUNTERS = {"steps": ("env_steps", 1e-6), "time": ("wall_s", 1.0 / 60.0)}
"""The counter behind an axis, and what one of it is there."""
X_LABELS = {"steps": "environment steps [million]", "time": "working time [min]", "epoch": "epoch"}
RATES = ("success_rate", "train_success_rate", "alpha", "epsilon", "beta", "transfer_share")
"""Figures between 0 and 1."""


@dataclass(frozen=True)
class RunMetrics:
    """The figures of one run by epoch."""

    stage: Values
    """Number of the stage of each epoch `[n]`."""
    columns: dict[str, Values]
    """Figures `[n]` by name; NaN where an epoch has none."""
    problem: str = ""
    """Why not all could be read."""


def metrics_of(folder: Path) -> RunMetrics:
    """The figures of the run in this folder as they are now; what cannot be read is missing and said."""
    path = folder / "metrics.jsonl"
    return _read(str(path), signature(path))


@lru_cache(maxsize=256)
def _read(path: str, _seen: Signature) -> RunMetrics:
    reader, rows, problem = LineReader(Path(path)), [], ""
    try:
        rows = reader.read_new()
    except RunFileError as error:
        problem = str(error)
    names = [*METRICS, *(counter for counter, _ in COUNTERS.values())]
    columns = {name: np.array([_number(row.get(name)) for row in rows], dtype=np.float64) for name in names}
    stage = np.nan_to_num(np.array([_number(row.get("stage")) for row in rows], dtype=np.float64))
    return RunMetrics(stage, columns, problem)


def _number(value: object) -> float:
    fits = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
    return float(value) if fits else float("nan")  # type: ignore[arg-type]


@dataclass(frozen=True)
class Look:
    """How curves are looked at."""

    x: str = "steps"
    stages: str = "all"
    smooth: float = 0.0
    """Weight of the past, 0..1."""


def curve_of(metrics: RunMetrics, metric: str, look: Look, label: str, ink: str, dashed: bool = False) -> RunCurve:
    """One figure of one run as a curve; epochs that did not measure it are left out."""
    x, y, stage = _points(metrics, metric, look)
    keep = thin_index(len(x), limit=MOST_POINTS)
    x, y, stage = x[keep], y[keep], stage[keep]
    ends = np.flatnonzero(np.diff(stage))
    # Stage by stage: what was learned of an easier task is not the past of the next one.
    parts = [smoothed(part, look.smooth) for part in np.split(y, ends + 1)]
    even = np.concatenate(parts) if look.smooth else y
    return RunCurve(label, ink, x, y, even, ends=tuple(int(end) for end in ends), dashed=dashed)


def _points(metrics: RunMetrics, metric: str, look: Look) -> tuple[Values, Values, Values]:
    stage, values = metrics.stage, metrics.columns[metric]
    counter, unit = COUNTERS.get(look.x, ("", 1.0))
    counted = metrics.columns[counter] if counter else np.ones(len(stage))
    if look.stages == "last" and len(stage):
        last = stage == stage[-1]
        stage, values, counted = stage[last], values[last], counted[last]
    x = positions(stage, counted) * unit if counter else np.cumsum(counted)
    known = np.isfinite(values)
    return x[known], values[known], stage[known]


def group_curve(members: Sequence[RunMetrics], metric: str, look: Look, label: str, ink: str) -> RunCurve | None:
    """Interquartile mean over runs with its 95 % bootstrap interval; None where none of them measured the figure.

    A run counts with its latest value, also behind its end, when its policy is kept; before its first one with that.
    """
    parts = [(x, y) for x, y, _ in (_points(each, metric, look) for each in members) if len(x)]
    if not parts:
        return None
    grid = np.unique(np.concatenate([x for x, _ in parts]))
    grid = grid[thin_index(len(grid), limit=GRID)]
    runs = np.stack([y[np.maximum(np.searchsorted(x, grid, side="right") - 1, 0)] for x, y in parts], axis=-1)
    found = bootstrap([runs], replicates=REPLICATES)
    value, low, high = (smoothed(part, look.smooth) for part in found)
    words = f"{label} · {len(parts)} run{'s' * (len(parts) != 1)}"
    return RunCurve(words, ink, grid, found.value, value, band=(low, high))
