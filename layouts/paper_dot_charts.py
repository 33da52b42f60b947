"""Table 4 to point at: every seed a dot, the interquartile mean with its interval, and the paper's number beside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, FixedTicker, HoverTool, Range1d
from bokeh.plotting import figure

from layouts.chart import add_csv, plain
from layouts.paper_inks import ink
from layouts.theme import NEUTRAL

ROW_HEIGHT = 36
SPREAD = 0.22
"""How far dots of one algorithm are spread, in rows."""


@dataclass(frozen=True)
class DotRow:
    """One algorithm in one quantity, in plotting units."""

    algorithm: str
    label: str
    values: Sequence[float]
    """One for every seed."""
    names: Sequence[str]
    """How each dot is called."""
    keys: Sequence[str]
    """What a tap on each dot stands for."""
    best: int | None
    """Index of the seed that the paper would show."""
    middle: float | None
    """Interquartile mean; None without a seed."""
    low: float
    high: float
    """Its interval; NaN where there is none."""
    paper: float


def dot_chart(title: str, rows: Sequence[DotRow], x_range: tuple[float, float]) -> tuple[figure, ColumnDataSource]:
    """A row for each algorithm, the first on top; returns the chart and the source of its dots."""
    count = len(rows)
    fig = figure(
        title=title, height=ROW_HEIGHT * count + 76, sizing_mode="stretch_width", tools="tap,save", active_drag=None,
        x_range=Range1d(*x_range), y_range=Range1d(-count + 0.4, 0.6), min_border_right=14,
    )  # fmt: skip
    plain(fig)
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    fig.yaxis.ticker = FixedTicker(ticks=[-place for place in range(count)])
    fig.yaxis.major_label_overrides = {-place: row.label for place, row in enumerate(rows)}
    fig.ygrid.grid_line_alpha = 0.0
    _paper(fig, rows)
    _intervals(fig, rows)
    return fig, _dots(fig, rows)


def _dots(fig: figure, rows: Sequence[DotRow]) -> ColumnDataSource:
    columns: dict[str, list[object]] = {n: [] for n in ("value", "row", "algorithm", "name", "key", "ink", "ring")}
    for place, row in enumerate(rows):
        spread = np.linspace(-SPREAD, SPREAD, len(row.values)) if len(row.values) > 1 else np.zeros(len(row.values))
        for index, value in enumerate(row.values):
            values = (value, -place + float(spread[index]), row.label, row.names[index], row.keys[index],
                      ink(row.algorithm), 2.4 if index == row.best else 0.8)  # fmt: skip
            for column, cell in zip(columns.values(), values, strict=True):
                column.append(cell)
    source = ColumnDataSource(columns)
    dots = fig.scatter("value", "row", source=source, size=10, fill_color="ink", fill_alpha=0.45, line_color="ink",
                       line_width="ring", name="seeds")  # fmt: skip
    dots.nonselection_glyph = None
    fig.add_tools(HoverTool(renderers=[dots], tooltips=[("", "@name"), ("", "@value{0.0}")], visible=False))
    add_csv(fig, "seeds", source)
    return source


def _intervals(fig: figure, rows: Sequence[DotRow]) -> None:
    shown = [(-place, row) for place, row in enumerate(rows) if row.middle is not None]
    source = ColumnDataSource(
        {
            "row": [place for place, _ in shown],
            "middle": [row.middle for _, row in shown],
            "low": [row.low for _, row in shown],
            "high": [row.high for _, row in shown],
            "ink": [ink(row.algorithm) for _, row in shown],
            "name": [f"{row.label}, interquartile mean of {len(row.values)} seeds" for _, row in shown],
        }
    )
    fig.segment("low", "row", "high", "row", source=source, color="ink", line_width=3.0, line_cap="round")
    middle = fig.scatter("middle", "row", source=source, marker="diamond", size=15, color="ink", line_color="white")
    tips = [("", "@name"), ("", "@middle{0.0}"), ("95 %", "@low{0.0} to @high{0.0}")]
    fig.add_tools(HoverTool(renderers=[middle], tooltips=tips, visible=False))


def _paper(fig: figure, rows: Sequence[DotRow]) -> None:
    source = ColumnDataSource(
        {
            "value": [row.paper for row in rows],
            "row": [-place for place in range(len(rows))],
            "top": [-place + 0.36 for place in range(len(rows))],
            "bottom": [-place - 0.36 for place in range(len(rows))],
            "name": [f"the paper's {row.label}, best of ten seeds" for row in rows],
        }
    )
    fig.segment("value", "bottom", "value", "top", source=source, color=NEUTRAL, line_width=2.0)
    mark = fig.scatter("value", "top", source=source, marker="inverted_triangle", size=10, color=NEUTRAL, name="paper")
    fig.add_tools(HoverTool(renderers=[mark], tooltips=[("", "@name"), ("", "@value{0.0}")], visible=False))
