"""Learning curves over a run's epochs (Fig. 8): success, return and the adaptive weights, by stage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, LegendItem, Range1d
from bokeh.plotting import figure

from layouts.chart import MAX_POINTS, Columns, add_csv, add_lines, plain, thin_index
from layouts.theme import NEUTRAL, POLICY_A, POLICY_B, SUCCESS, missile_colour

Row = Mapping[str, Any]

CURVES = (
    "train_success_rate",
    "train_return_mean",
    "alpha",
    "epsilon",
    "beta",
    "transfer_share",
    "critic_loss",
    "q_mean",
)
HELD_OUT = ("success_rate", "return_mean")


@dataclass(frozen=True)
class LearningCurves:
    """Figures and the three sources they share; `update` fills the sources in place from metrics rows."""

    success: figure
    returns: figure
    weights: figure
    training: ColumnDataSource
    held_out: ColumnDataSource
    stages: ColumnDataSource

    def update(self, rows: Sequence[Row]) -> None:
        """Show these metrics rows (all of the run's, oldest first)."""
        self.training.data = training_columns(rows)
        self.held_out.data = held_out_columns(rows)
        self.stages.data = stage_columns(rows)


def learning_curves(rows: Sequence[Row] = (), height: int = 240) -> LearningCurves:
    """Success rate, return and alpha, epsilon, beta over all epochs; dashed lines part the stages."""
    training, held_out, stages = (
        ColumnDataSource(make(rows)) for make in (training_columns, held_out_columns, stage_columns)
    )
    success = _sheet("success rate", height, None, Range1d(-0.02, 1.04))
    returns = _sheet("episode return", height, success, None)
    weights = _sheet("adaptive weights", height, success, Range1d(-0.02, 1.04))
    add_lines(success, training, "epoch", [("train_success_rate", "while training", NEUTRAL)])
    _add_held_out(success, held_out, "success_rate", SUCCESS)
    add_lines(returns, training, "epoch", [("train_return_mean", "while training", NEUTRAL)])
    _add_held_out(returns, held_out, "return_mean", POLICY_A)
    inks = [
        ("alpha", "α distillation", POLICY_A),
        ("epsilon", "ε reuse", POLICY_B),
        ("beta", "β success", SUCCESS),
    ]
    add_lines(weights, training, "epoch", [*inks, ("transfer_share", "transfer allowed", missile_colour(1))])
    for fig, name in ((success, "success"), (returns, "return"), (weights, "weights")):
        _add_stages(fig, stages, label=fig is success)
        add_csv(fig, f"learning-{name}", training)
    return LearningCurves(success, returns, weights, training, held_out, stages)


def training_columns(rows: Sequence[Row]) -> Columns:
    """`epoch` counted through all stages from 1, and the curves of every epoch; NaN where a row has none."""
    index = thin_index(len(rows), limit=MAX_POINTS)
    columns: Columns = {"epoch": index + 1.0}
    for name in CURVES:
        columns[name] = np.array([_number(rows[i].get(name)) for i in index], dtype=float)
    return columns


def held_out_columns(rows: Sequence[Row]) -> Columns:
    """`epoch`, `success_rate` and `return_mean` of the epochs evaluated on held-out initial states."""
    kept = [i for i, row in enumerate(rows) if row.get("success_rate") is not None]
    columns: Columns = {"epoch": np.array(kept, dtype=float) + 1.0}
    for name in HELD_OUT:
        columns[name] = np.array([_number(rows[i].get(name)) for i in kept], dtype=float)
    return columns


def stage_columns(rows: Sequence[Row]) -> Columns:
    """`epoch` at which each stage begins (minus one half) and its `task`."""
    starts = [i for i, row in enumerate(rows) if i == 0 or row.get("stage") != rows[i - 1].get("stage")]
    tasks = np.array([str(rows[i].get("task", "")) for i in starts], dtype=object)
    return {"epoch": np.array(starts, dtype=float) + 0.5, "task": tasks, "top": np.ones(len(starts))}


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")


def _sheet(title: str, height: int, linked: figure | None, y_range: Range1d | None) -> figure:
    ranges: dict[str, Any] = {"x_range": linked.x_range} if linked else {}
    if y_range:
        ranges["y_range"] = y_range
    fig = figure(
        title=title,
        height=height,
        sizing_mode="stretch_width",
        x_axis_label="epoch",
        active_drag=None,
        tools="xpan,xwheel_zoom,box_zoom,reset,save",
        **ranges,
    )
    plain(fig)
    return fig


def _add_held_out(fig: figure, source: ColumnDataSource, column: str, colour: str) -> None:
    line = fig.line("epoch", column, source=source, color=colour, line_width=2.5)
    dots = fig.scatter("epoch", column, source=source, color=colour, size=6)
    fig.legend[0].items.append(LegendItem(label="held-out evaluation", renderers=[line, dots]))


def _add_stages(fig: figure, stages: ColumnDataSource, label: bool) -> None:
    fig.vspan(x="epoch", source=stages, line_color=NEUTRAL, line_dash="dashed", line_width=1)
    if label:
        fig.text(
            x="epoch",
            y="top",
            text="task",
            source=stages,
            text_color=NEUTRAL,
            text_font_size="11px",
            x_offset=4,
            text_baseline="top",
        )
