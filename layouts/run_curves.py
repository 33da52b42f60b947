"""Curves of several runs over each other: over steps, time or epochs, smoothed, bands over seeds, a baseline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure
from numpy.typing import NDArray

from layouts.chart import add_csv, empty, plain
from layouts.theme import NEUTRAL

Values = NDArray[np.float64]

RUN_INKS = (
    "#2f86ff", "#e08a00", "#1fa05f", "#e0489c", "#9a63f5", "#0f9fb5", "#e5414d", "#986600", "#5b7cc4", "#a0577e",
)  # fmt: skip
"""Ink of a curve by its place; mid-tones that read on dark and on light."""
BASELINE_INK = NEUTRAL
_MARGIN = 0.05


@dataclass(frozen=True)
class RunCurve:
    """One curve of one figure."""

    label: str
    ink: str
    x: Values
    """`[n]`, ascending."""
    raw: Values
    """`[n]` as measured."""
    y: Values
    """`[n]` smoothed."""
    band: tuple[Values, Values] | None = None
    """Bounds `[n]` of an interval over seeds."""
    ends: tuple[int, ...] = ()
    """Indices of the last points of stages but the last."""
    dashed: bool = False
    """The pinned baseline."""


@dataclass(frozen=True)
class Level:
    """A value to compare with, as a line across the figure."""

    label: str
    value: float


@dataclass
class CurveFigure:
    """One figure; `show` changes it in place. Zooming by hand is left alone while only data come."""

    figure: figure
    lines: ColumnDataSource = field(default_factory=lambda: empty(("xs", "ys", "ink", "dash")))
    faint: ColumnDataSource = field(default_factory=lambda: empty(("xs", "ys", "ink")))
    bands: ColumnDataSource = field(default_factory=lambda: empty(("xs", "ys", "ink")))
    points: ColumnDataSource = field(default_factory=lambda: empty(("x", "y", "raw", "label", "ink")))
    ends: ColumnDataSource = field(default_factory=lambda: empty(("x", "y", "ink")))
    levels: ColumnDataSource = field(default_factory=lambda: empty(("y", "label")))
    _framed: tuple[float, ...] = ()

    def show(
        self, curves: Sequence[RunCurve], title: str, x_label: str, levels: Sequence[Level] = (), rate: bool = False
    ) -> None:
        """Draw these curves; `rate` keeps the axis from 0 to 1."""
        self.figure.title.text = title  # type: ignore[union-attr]
        self.figure.xaxis[0].axis_label = x_label
        self.lines.data = _lines(curves)
        self.faint.data = _raw(curves)
        self.bands.data = _bands(curves)
        self.points.data = _points(curves)
        self.ends.data = _stage_ends(curves)
        frame = _frame(curves, levels, rate)
        self.levels.data = {"y": [level.value for level in levels], "label": [level.label for level in levels]}
        self._reframe(frame)

    def _reframe(self, frame: tuple[float, ...]) -> None:
        x, y = self.figure.x_range, self.figure.y_range
        if frame == self._framed:
            return
        self._framed = frame
        x.update(start=frame[0], end=frame[1])
        y.update(start=frame[2], end=frame[3])


def curve_figure(name: str, height: int = 300) -> CurveFigure:
    """An empty figure; `name` is what its downloads are called."""
    fig = figure(
        title=" ", height=height, sizing_mode="stretch_width", active_drag=None, min_border_right=12,
        tools="xpan,xwheel_zoom,box_zoom,reset,save", x_range=Range1d(0.0, 1.0), y_range=Range1d(0.0, 1.0),
    )  # fmt: skip
    plain(fig)
    sheet = CurveFigure(fig)
    fig.patches("xs", "ys", source=sheet.bands, fill_color="ink", fill_alpha=0.2, line_alpha=0.0)
    fig.hspan(y="y", source=sheet.levels, line_color=BASELINE_INK, line_dash="dashed", line_width=1.8)
    fig.multi_line("xs", "ys", source=sheet.faint, line_color="ink", line_alpha=0.28, line_width=1.2)
    fig.multi_line(
        "xs", "ys", source=sheet.lines, line_color="ink", line_width=2.2, line_dash="dash", line_join="round"
    )
    fig.scatter("x", "y", source=sheet.ends, marker="diamond", size=9, fill_color="ink", line_color="ink")
    dots = fig.scatter("x", "y", source=sheet.points, size=5, fill_color="ink", line_alpha=0.0, fill_alpha=0.0)
    dots.nonselection_glyph = None
    tips = [("", "@label"), ("at", "@x{0.00}"), ("value", "@y{0.000}"), ("as measured", "@raw{0.000}")]
    fig.add_tools(HoverTool(renderers=[dots], tooltips=tips, visible=False))
    add_csv(fig, name, sheet.points)
    return sheet


def positions(stage: Values, values: Values) -> Values:
    """Where each epoch `[n]` lies on an axis whose counter starts anew with every stage, and may with a resumption.

    A missing value stands where the one before it stood.
    """
    if not len(values):
        return values
    known = np.maximum.accumulate(np.where(np.isnan(values), 0, np.arange(len(values))))
    values = np.nan_to_num(values[known])
    anew = (np.diff(stage) != 0) | (np.diff(values) < 0)
    return values + np.concatenate([[0.0], np.cumsum(np.where(anew, values[:-1], 0.0))])


def smoothed(values: Values, weight: float) -> Values:
    """Exponential mean of `[n]` values, each past one weighing `weight` (0..1) times the next, unbiased."""
    if weight <= 0.0:
        return values
    mean, mass, out = 0.0, 0.0, np.empty_like(values)
    for index, value in enumerate(values):
        mean = weight * mean + (1.0 - weight) * value
        mass = weight * mass + (1.0 - weight)
        out[index] = mean / mass
    return out


def _lines(curves: Sequence[RunCurve]) -> dict[str, list[object]]:
    return {
        "xs": [curve.x for curve in curves],
        "ys": [curve.y for curve in curves],
        "ink": [curve.ink for curve in curves],
        "dash": ["dashed" if curve.dashed else "solid" for curve in curves],
    }


def _raw(curves: Sequence[RunCurve]) -> dict[str, list[object]]:
    """What was measured, where smoothing has changed it."""
    changed = [curve for curve in curves if curve.raw is not curve.y]
    return {
        "xs": [curve.x for curve in changed],
        "ys": [curve.raw for curve in changed],
        "ink": [curve.ink for curve in changed],
    }


def _bands(curves: Sequence[RunCurve]) -> dict[str, list[object]]:
    banded = [(curve, *curve.band) for curve in curves if curve.band is not None and np.isfinite(curve.band[0]).any()]
    return {
        "xs": [np.concatenate([curve.x, curve.x[::-1]]) for curve, _low, _high in banded],
        "ys": [np.concatenate([low, high[::-1]]) for _curve, low, high in banded],
        "ink": [curve.ink for curve, _low, _high in banded],
    }


def _points(curves: Sequence[RunCurve]) -> dict[str, object]:
    def joined(name: str) -> Values:
        return np.concatenate([getattr(curve, name) for curve in curves]) if curves else np.empty(0)

    counts = [len(curve.x) for curve in curves]
    return {
        "x": joined("x"),
        "y": joined("y"),
        "raw": joined("raw"),
        "label": [curve.label for curve, count in zip(curves, counts, strict=True) for _ in range(count)],
        "ink": [curve.ink for curve, count in zip(curves, counts, strict=True) for _ in range(count)],
    }


def _stage_ends(curves: Sequence[RunCurve]) -> dict[str, list[object]]:
    ends = [(curve, end) for curve in curves for end in curve.ends if end < len(curve.x)]
    return {
        "x": [float(curve.x[end]) for curve, end in ends],
        "y": [float(curve.y[end]) for curve, end in ends],
        "ink": [curve.ink for curve, _end in ends],
    }


def _frame(curves: Sequence[RunCurve], levels: Sequence[Level], rate: bool) -> tuple[float, float, float, float]:
    """X from, x to, y from, y to."""
    right = max((float(curve.x[-1]) for curve in curves if len(curve.x)), default=1.0) or 1.0
    if rate:
        return 0.0, right, -0.02, 1.04
    parts = [curve.y for curve in curves] + [bound for curve in curves if curve.band for bound in curve.band]
    heights = np.concatenate([*parts, [level.value for level in levels]]) if parts or levels else np.empty(0)
    heights = heights[np.isfinite(heights)]
    if not heights.size:
        return 0.0, right, 0.0, 1.0
    low, high = float(heights.min()), float(heights.max())
    margin = _MARGIN * (high - low) or max(abs(high), 1.0) * _MARGIN
    return 0.0, right, low - margin, high + margin
