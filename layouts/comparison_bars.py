"""Bars of several policies on several tasks: success and return with intervals (Fig. 13), causes of failure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from bokeh.models import ColumnDataSource, FixedTicker, HoverTool, Range1d
from bokeh.plotting import figure

from layouts.chart import add_csv, empty, plain
from layouts.comparison_inks import cause_ink, cause_words
from layouts.theme import NEUTRAL

GROUP = 0.84
"""Share of a task's place that its bars fill."""
GAP = 0.12
"""Share of a bar's place that stays free."""
NARROW = 30
"""With more bars than this their values are told by pointing at them alone."""
COLUMNS = ("task", "policy", "x", "width", "value", "low", "high", "colour", "hatch", "words", "note")
CAUSE_COLUMNS = ("task", "policy", "cause", "x", "width", "bottom", "top", "share", "count", "colour", "hatch", "note")


@dataclass(frozen=True)
class Bar:
    """One policy on one task."""

    task: str
    policy: str
    """Its name in words."""
    colour: str
    value: float | None
    """None where there is none yet."""
    low: float | None = None
    high: float | None = None
    causes: Mapping[str, float] | None = None
    """Share of the engagements lost to each cause [%]."""
    counts: Mapping[str, int] | None = None
    """Number of them."""
    elsewhere: bool = False
    """It was trained for something else: hatched."""
    note: str = ""
    """What else is said of it when it is pointed at."""


@dataclass(frozen=True)
class BarChart:
    """A figure changed in place by `show`: tasks from left to right, in each the policies in their order."""

    figure: figure
    source: ColumnDataSource
    fill: Callable[[BarChart, Sequence[str], Sequence[Bar]], None]

    def show(self, tasks: Sequence[str], bars: Sequence[Bar]) -> None:
        """Show these bars; a task's are all of that name, in their order."""
        fig = self.figure
        fig.x_range.update(start=-0.5, end=len(tasks) - 0.5)
        fig.xaxis[0].ticker = FixedTicker(ticks=list(range(len(tasks))))
        fig.xaxis[0].major_label_overrides = dict(enumerate(tasks))
        fig.xaxis[0].major_label_orientation = "horizontal" if len(tasks) <= 8 else 0.5
        self.fill(self, tasks, bars)


def success_chart(height: int) -> BarChart:
    """Success rate [%] with Wilson intervals."""
    return _interval_chart("Success rate [%]", "success", Range1d(0.0, 112.0), height, "0.0", _in_range)


def return_chart(height: int) -> BarChart:
    """Mean return with its interval."""
    return _interval_chart("Mean return of an engagement", "return", Range1d(0.0, 1.0), height, "0.0", _fit_range)


def cause_chart(height: int) -> BarChart:
    """Engagements lost [%], stacked by cause."""
    fig = _sheet("Causes of failure [% of the engagements]", Range1d(0.0, 1.0), height)
    source = empty(CAUSE_COLUMNS)
    drawn = fig.vbar(
        "x", "width", "top", "bottom", source=source, fill_color="colour", line_color=None, hatch_pattern="hatch",
        hatch_color="white", hatch_alpha=0.5, hatch_scale=9, hatch_weight=1.5,
    )  # fmt: skip
    drawn.nonselection_glyph = None
    tips = [("", "@policy on @task"), ("", "@cause: @count (@share{0.0} %)"), ("", "@note")]
    fig.add_tools(HoverTool(renderers=[drawn], tooltips=tips, visible=False))
    add_csv(fig, "comparison-causes", source)
    return BarChart(fig, source, _fill_causes)


def _interval_chart(
    title: str, name: str, y_range: Range1d, height: int, form: str, scale: Callable[[figure, Sequence[Bar]], None]
) -> BarChart:
    fig, source = _sheet(title, y_range, height), empty(COLUMNS)
    drawn = fig.vbar(
        "x", "width", "value", source=source, fill_color="colour", line_color=None, hatch_pattern="hatch",
        hatch_color="white", hatch_alpha=0.5, hatch_scale=9, hatch_weight=1.5,
    )  # fmt: skip
    drawn.nonselection_glyph = None
    fig.segment("x", "low", "x", "high", source=source, line_color=NEUTRAL, line_width=2.5)
    fig.text(
        "x", "high", "words", source=source, text_color=NEUTRAL, text_font_size="10px", text_align="center",
        text_baseline="bottom", y_offset=-3,
    )  # fmt: skip
    tips = [
        ("", "@policy on @task"),
        ("", f"@value{{{form}}}  (95 %: @low{{{form}}} to @high{{{form}}})"),
        ("", "@note"),
    ]
    fig.add_tools(HoverTool(renderers=[drawn], tooltips=tips, visible=False))
    add_csv(fig, f"comparison-{name}", source)

    def fill(chart: BarChart, tasks: Sequence[str], bars: Sequence[Bar]) -> None:
        scale(chart.figure, bars)
        chart.source.data = bar_columns(tasks, bars)

    return BarChart(fig, source, fill)


def bar_columns(tasks: Sequence[str], bars: Sequence[Bar]) -> dict[str, list]:
    """Columns of bars that have a value, with their places."""
    rows = []
    for x, width, bar in places(tasks, bars):
        if bar.value is None:
            continue
        low, high = (bar.value if bound is None else bound for bound in (bar.low, bar.high))
        words = f"{bar.value:.3g}" if len(bars) <= NARROW else ""
        hatch = "right_diagonal_line" if bar.elsewhere else " "
        rows.append((bar.task, bar.policy, x, width, bar.value, low, high, bar.colour, hatch, words, bar.note))
    return {name: [row[i] for row in rows] for i, name in enumerate(COLUMNS)}


def places(tasks: Sequence[str], bars: Sequence[Bar]) -> list[tuple[float, float, Bar]]:
    """Middle and width of every bar: tasks are 1 apart, bars of a task stand side by side around its middle."""
    placed = []
    for position, task in enumerate(tasks):
        members = [bar for bar in bars if bar.task == task]
        room = GROUP / max(len(members), 1)
        for number, bar in enumerate(members):
            placed.append((position + (number - (len(members) - 1) / 2.0) * room, room * (1.0 - GAP), bar))
    return placed


def _fill_causes(chart: BarChart, tasks: Sequence[str], bars: Sequence[Bar]) -> None:
    rows, highest = [], 0.0
    for x, width, bar in places(tasks, bars):
        bottom = 0.0
        for cause, share in (bar.causes or {}).items():
            ink, hatch = cause_ink(cause), "right_diagonal_line" if cause == "shot_down" else " "
            count = (bar.counts or {}).get(cause, 0)
            words = cause_words(cause)
            rows.append(
                (bar.task, bar.policy, words, x, width, bottom, bottom + share, share, count, ink, hatch, bar.note)
            )
            bottom += share
        highest = max(highest, bottom)
    chart.figure.y_range.update(start=0.0, end=max(highest * 1.08, 1.0))
    chart.source.data = {name: [row[i] for row in rows] for i, name in enumerate(CAUSE_COLUMNS)}


def _in_range(fig: figure, bars: Sequence[Bar]) -> None:
    """Percentages always have the same scale."""


def _fit_range(fig: figure, bars: Sequence[Bar]) -> None:
    values = [value for bar in bars for value in (bar.value, bar.low, bar.high) if value is not None]
    low, high = min([0.0, *values]), max([1.0, *values])
    fig.y_range.update(start=low * 1.1, end=high + 0.12 * (high - low))


def _sheet(title: str, y_range: Range1d, height: int) -> figure:
    fig = figure(
        title=title, height=height, sizing_mode="stretch_width", x_range=Range1d(-0.5, 0.5), y_range=y_range,
        tools="save", active_drag=None,
    )  # fmt: skip
    plain(fig)
    fig.xgrid.visible = False
    fig.xaxis.major_tick_line_color = None
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    return fig
