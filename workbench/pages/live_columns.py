"""The figures of a watched run as curves: over which axis, smoothed how much."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from layouts.chart import Columns
from layouts.learning_curves import RAW, RunLearning
from layouts.learning_panels import PANELS
from layouts.run_curves import positions, smoothed
from workbench.pages.live_settings import LiveSettings
from workbench.pages.live_watch import RunWatch
from workbench.pages.runs_metrics import COUNTERS

Values = NDArray[np.float64]


def learning_of(watch: RunWatch, settings: LiveSettings) -> RunLearning:
    """Every curve of a run as the settings want it; columns of a run that goes on only grow at their end."""
    stage = np.array(watch.columns["stage"])
    x = axis(watch, settings.x)
    measured = np.isfinite(np.array(watch.columns["success_rate"]))
    return RunLearning(
        key=(watch.run.id, watch.anew, settings.x, settings.smooth),
        epochs=_columns(watch, settings, x, stage, np.ones(len(x), bool), held_out=False),
        held_out=_columns(watch, settings, x, stage, measured, held_out=True),
    )


def axis(watch: RunWatch, name: str) -> Values:
    """Where each epoch lies `[n]`: million steps, minutes of work, or epochs, counted through all stages."""
    if name not in COUNTERS:
        return np.arange(1.0, len(watch.tasks) + 1.0)
    counter, unit = COUNTERS[name]
    return positions(np.array(watch.columns["stage"]), np.array(watch.columns[counter])) * unit


def stage_starts(watch: RunWatch, x: Values) -> Columns:
    """`x` at which each stage begins [axis units] and its `task`; a stage begins where the one before has ended."""
    stage = np.array(watch.columns["stage"])
    starts = [0, *(np.flatnonzero(np.diff(stage)) + 1).tolist()] if len(stage) else []
    places = [0.0 if start == 0 else float(x[start - 1]) for start in starts]
    tasks = np.array([watch.tasks[start] for start in starts], dtype=object)
    return {"x": np.array(places), "task": tasks}


def _columns(
    watch: RunWatch, settings: LiveSettings, x: Values, stage: Values, kept: NDArray[np.bool_], held_out: bool
) -> Columns:
    columns: Columns = {"x": x[kept], "run": np.full(int(kept.sum()), watch.run.id, dtype=object)}
    for curve in (curve for panel in PANELS for curve in panel.curves if curve.held_out == held_out):
        values = np.array(watch.columns[curve.name])[kept]
        columns[curve.name + RAW] = values
        columns[curve.name] = _smooth(values, stage[kept], settings.smooth / 100.0)
    return columns


def _smooth(values: Values, stage: Values, weight: float) -> Values:
    """Smoothed stage by stage: what was learned of an easier task is not the past of the next one."""
    if weight <= 0.0 or not len(values):
        return values
    parts = np.split(values, np.flatnonzero(np.diff(stage)) + 1)
    return np.concatenate([_smooth_known(part, weight) for part in parts])


def _smooth_known(part: Values, weight: float) -> Values:
    """Smoothed where measured; a missing value stays missing and is no one's past."""
    known, even = np.isfinite(part), part.copy()
    even[known] = smoothed(part[known], weight)
    return even
