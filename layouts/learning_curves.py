"""Learning curves (Fig. 8) in small multiples over one axis; they grow by streaming, nothing is drawn twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from bokeh.models import (
    BasicTicker,
    ColumnDataSource,
    CustomAction,
    CustomJS,
    GlyphRenderer,
    InlineStyleSheet,
    LabelSet,
    Line,
    Range1d,
    Scatter,
)
from bokeh.plotting import figure

from layouts.chart import Columns, add_csv, empty, plain
from layouts.learning_panels import PANELS, LearningCurve, LearningPanel
from layouts.run_curves import RUN_INKS
from layouts.theme import NEUTRAL

HOVER_TAG = "learning-curves"
"""Tag of every figure over which the page draws one line under the pointer."""
MAX_POINTS = 2000
"""Epochs of a run that are drawn; of a longer one every second, every fourth …"""
RAW = "_raw"
"""End of the name of a column as it was measured, before it was smoothed."""
_TOOLBAR_CSS = """
:host { background: color-mix(in srgb, var(--panel-background-color, #888) 82%, transparent) !important;
  border-radius: 6px; width: max-content !important; margin-left: auto }
"""
_DASHES = ("solid", "dashed", "dotted")


@dataclass(frozen=True)
class RunLearning:
    """What one run has learned so far, as columns of equal length; `x` [axis units] and `run` are among them."""

    key: tuple[object, ...]
    """Which run is looked at, and how: as long as it stays, columns only grow at their end."""
    epochs: Columns
    """One value per epoch."""
    held_out: Columns
    """One value per held-out evaluation."""


@dataclass
class _Feed:
    """A source that is sent only what it does not have."""

    source: ColumnDataSource
    key: object = None
    seen: int = 0
    """Rows taken so far, drawn or left out."""
    stride: int = 1
    """Every how many-th row is drawn."""

    def take(self, key: object, columns: Columns) -> None:
        """Draw these columns: stream their new end, or begin anew where they are others."""
        length = len(columns["x"])
        stride = 1
        while length > MAX_POINTS * stride:
            stride *= 2
        if (key, stride) != (self.key, self.stride) or length < self.seen:
            self.source.data = {name: values[::stride] for name, values in columns.items()}
        elif length > self.seen:
            first = -(-self.seen // stride) * stride
            if first < length:
                self.source.stream({name: values[first::stride] for name, values in columns.items()})
        self.key, self.seen, self.stride = key, length, stride


@dataclass
class _Window:
    """An axis that follows what is drawn until a person zooms, and again after a reset."""

    range: Range1d
    framed: tuple[float, float] | None = None

    def follow(self, low: float, high: float) -> None:
        """What is drawn lies between these."""
        following = self.framed is None or (self.range.start, self.range.end) == self.framed
        if following and (low, high) != self.framed:
            self.range.update(start=low, end=high, reset_start=low, reset_end=high)
            self.framed = (low, high)
        elif not following and (low, high) != self.framed:
            self.range.update(reset_start=low, reset_end=high)
            self.framed = (low, high)


@dataclass
class _Slot:
    """The place of one run in all figures, made once and used by whatever run stands there."""

    epochs: _Feed
    held_out: _Feed
    lines: list[tuple[int, LearningCurve, GlyphRenderer]] = field(default_factory=list)
    """Number of the curve in its panel, the curve, and what draws it."""
    raw: list[tuple[int, LearningCurve, GlyphRenderer]] = field(default_factory=list)
    """The same as measured, faint behind the smoothed ones."""

    def clear(self) -> None:
        """Show no run."""
        for feed in (self.epochs, self.held_out):
            if feed.seen or feed.key is not None:
                feed.take(None, {name: np.empty(0) for name in feed.source.data})


class LearningCurves:
    """One figure per panel, filled in place by `show`."""

    def __init__(self, height: int = 190) -> None:
        self._x_range = _Window(Range1d(0.0, 1.0))
        self._y_ranges = {panel.key: _Window(Range1d(-0.03, 1.05)) for panel in PANELS}
        self.stages = empty(("x", "task"))
        """Where the stages of the first run begin [axis units], and their tasks."""
        self._slots: list[_Slot] = []
        self.figures = {panel.key: self._figure(panel, height) for panel in PANELS}
        self._csv = {key: _csv_callback(fig) for key, fig in self.figures.items()}
        self._hidden: frozenset[str] = frozenset()
        self._styled: tuple[object, ...] = ()

    def show(self, runs: Sequence[RunLearning], stages: Columns, x_label: str, smooth: bool) -> None:
        """Draw these runs, the first one with its stages; with one run each curve has its ink, else each run."""
        if _differs(self.stages, stages):
            self.stages.data = dict(stages)
        for number, run in enumerate(runs):
            slot = self._slot(number)
            slot.epochs.take(run.key, run.epochs)
            slot.held_out.take(run.key, run.held_out)
        for slot in self._slots[len(runs) :]:
            slot.clear()
        self._style(len(runs) > 1, smooth)
        for fig in self.figures.values():
            fig.xaxis[0].axis_label = x_label
        self._frame(runs)

    def _frame(self, runs: Sequence[RunLearning]) -> None:
        """Let the axes follow what is drawn."""
        ends = [float(columns["x"][-1]) for run in runs for columns in (run.epochs, run.held_out) if len(columns["x"])]
        self._x_range.follow(0.0, 1.02 * (max(ends, default=0.0) or 1.0))
        for panel in PANELS:
            if not panel.rate:
                low, high = _extent(panel, runs, self._hidden)
                margin = 0.07 * (high - low) or 0.07 * max(abs(high), 1.0)
                self._y_ranges[panel.key].follow(low - margin, high + margin)

    def hide(self, names: Sequence[str]) -> None:
        """Take the curves of these names out of the figures; all others are shown."""
        self._hidden = frozenset(names)
        for slot in self._slots:
            for _, curve, renderer in slot.lines:
                renderer.visible = curve.name not in self._hidden

    def _slot(self, number: int) -> _Slot:
        while len(self._slots) <= number:
            every = {curve.name: curve.held_out for panel in PANELS for curve in panel.curves}
            sources = []
            for held_out in (False, True):
                names = [name for name, late in every.items() if late == held_out]
                sources.append(empty(("x", "run", *names, *(name + RAW for name in names))))
            slot = _Slot(*(_Feed(source) for source in sources))
            self._draw(slot)
            self._slots.append(slot)
            self._styled = ()
        return self._slots[number]

    def _draw(self, slot: _Slot) -> None:
        for panel in PANELS:
            fig, used = self.figures[panel.key], []
            for number, curve in enumerate(panel.curves):
                source = (slot.held_out if curve.held_out else slot.epochs).source
                raw = Line(x="x", y=curve.name + RAW, line_width=1.1, line_alpha=0.3)
                line = Line(x="x", y=curve.name, line_width=2.0, line_join="round")
                slot.raw.append((number, curve, _add(fig, source, raw, visible=False)))
                slot.lines.append((number, curve, _add(fig, source, line, name=curve.name)))
                if curve.held_out:
                    dots = Scatter(x="x", y=curve.name, size=4.5, line_alpha=0.0)
                    slot.lines.append((number, curve, _add(fig, source, dots)))
                used += [source] if source not in used else []
            callback = self._csv[panel.key]
            callback.args = {**callback.args, "sources": [*callback.args["sources"], *used]}

    def _style(self, several: bool, smooth: bool) -> None:
        if self._styled == (several, smooth):
            return
        self._styled = (several, smooth)
        for place, slot in enumerate(self._slots):
            for number, curve, renderer in (*slot.lines, *slot.raw):
                ink = RUN_INKS[place % len(RUN_INKS)] if several else curve.ink
                renderer.glyph.line_color = ink
                if hasattr(renderer.glyph, "fill_color"):
                    renderer.glyph.fill_color = ink
                else:
                    renderer.glyph.line_dash = _DASHES[number] if several else "solid"
            for _, curve, renderer in slot.raw:
                renderer.visible = smooth and curve.name not in self._hidden
            for _, curve, renderer in slot.lines:
                renderer.visible = curve.name not in self._hidden

    def _figure(self, panel: LearningPanel, height: int) -> figure:
        fig = figure(
            height=height, sizing_mode="stretch_width", active_drag=None, min_border_right=10, min_border_left=44,
            tools="xpan,xwheel_zoom,box_zoom,reset,save", x_range=self._x_range.range,
            y_range=self._y_ranges[panel.key].range, tags=[HOVER_TAG],
        )  # fmt: skip
        plain(fig)
        fig.toolbar_inner = True  # above, it would take a line from a low figure
        fig.toolbar.stylesheets = [InlineStyleSheet(css=_TOOLBAR_CSS)]
        fig.background_fill_alpha = fig.border_fill_alpha = 0.0  # the panel's colour shows through
        fig.xaxis[0].axis_label_standoff = 1
        fig.xaxis[0].ticker = BasicTicker(desired_num_ticks=5)
        fig.yaxis[0].ticker = BasicTicker(desired_num_ticks=4)
        fig.axis.axis_label_text_font_size = fig.axis.major_label_text_font_size = "11px"
        fig.vspan(x="x", source=self.stages, line_color=NEUTRAL, line_dash="dashed", line_width=1)
        fig.add_layout(
            LabelSet(
                x="x",
                y=4,
                y_units="screen",
                text="task",
                source=self.stages,
                angle=np.pi / 2,
                y_offset=0,
                x_offset=10,
                text_font_size="9.5px",
                text_color=NEUTRAL,
            )
        )
        add_csv(fig, f"learning-{panel.key}")
        return fig


def _add(fig: figure, source: ColumnDataSource, glyph: Line | Scatter, **more: Any) -> GlyphRenderer:
    """Draw with this glyph; made by hand, as the figure's own methods make four glyphs of each."""
    return fig.add_glyph(source, glyph, nonselection_glyph=None, muted_glyph=None, **more)


def _csv_callback(fig: figure) -> CustomJS:
    """What writes the figure's numbers: it is told of every source that is added."""
    actions = [tool.callback for tool in fig.tools if isinstance(tool, CustomAction)]
    return next(each for each in actions if isinstance(each, CustomJS) and "sources" in each.args)


def _extent(panel: LearningPanel, runs: Sequence[RunLearning], hidden: frozenset[str]) -> tuple[float, float]:
    """The least and the greatest value of a panel's visible curves; 0 and 1 where there is none."""
    parts = [
        (run.held_out if curve.held_out else run.epochs)[curve.name]
        for run in runs for curve in panel.curves if curve.name not in hidden
    ]  # fmt: skip
    values = np.concatenate([np.empty(0), *parts])
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)


def _differs(source: ColumnDataSource, columns: Columns) -> bool:
    return any(list(source.data[name]) != list(values) for name, values in columns.items())
