"""The sheet every time curve is drawn on: clock cursor, click to set the clock, downloads as PNG and CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import (
    ColumnDataSource,
    CustomJS,
    GlyphRenderer,
    HoverTool,
    Legend,
    Range1d,
    Span,
    Title,
)
from bokeh.plotting import figure
from numpy.typing import NDArray

from layouts.figure_downloads import add_downloads
from layouts.theme import NEUTRAL, ink_dash
from sim.trajectory import Trajectory

Columns = dict[str, NDArray[Any]]
"""Equally long arrays by name, in plotting units; the first is the horizontal axis. Also what a CSV holds."""

Marks = dict[str, list[Any]]
"""Columns of a few marks, text among them."""

MAX_POINTS = 2500
CURSOR_TAG = "clock-cursor"
"""Tag of every figure on which the page draws its clock: over it, in the browser, without a redraw."""

OVER_TIME_TAG = "over-time"
"""Tag of those whose horizontal axis is the time: there the clock is a line, elsewhere only dots on the tracks."""

CLOCK_EVENT = "flight-clock"
"""Browser event that a click or a drag on a curve sends; its detail is the time [s]."""

_CLOCK_CODE = "window.dispatchEvent(new CustomEvent(event, {detail: cb_obj.x}))"
_DRAG_CODE = f"if (!fig.toolbar.gestures.pan?.active && !fig.toolbar.gestures.multi?.active) {{ {_CLOCK_CODE} }}"
"""A drag belongs to the tool that was chosen, if one was."""


def thin_index(length: int, keep: Sequence[int] = (), limit: int = MAX_POINTS) -> NDArray[np.intp]:
    """Ascending indices of about `limit` evenly spread samples of `length`, ends and `keep` included."""
    if length <= limit:
        return np.arange(length)
    spread = np.linspace(0, length - 1, limit - len(keep)).round().astype(np.intp)
    return np.unique(np.concatenate([spread, np.asarray(keep, dtype=np.intp)]))


def largest(*tables: Columns) -> float:
    """Largest finite value in any column but the first of each table; 1 when there is none."""
    columns = (values[np.isfinite(values)] for table in tables for values in list(table.values())[1:])
    return max((float(values.max()) for values in columns if values.size), default=1.0)


@dataclass(frozen=True)
class FlightChart:
    """A figure that can show any flight of a scenario: `show` changes it in place, so that it never flickers."""

    figure: figure
    source: ColumnDataSource
    columns: Callable[[Trajectory], Columns]
    ends: ColumnDataSource | None = None
    mark_ends: Callable[[Trajectory], Marks] | None = None

    def show(self, flight: Trajectory, title: str | None = None) -> None:
        """Show this flight; curves it does not have (masked missiles) stay empty and leave the legend."""
        columns = self.columns(flight)
        nothing = np.full(len(next(iter(columns.values()))), np.nan)
        self.source.data = {name: columns.get(name, nothing) for name in self.source.column_names}
        if self.ends is not None and self.mark_ends is not None:
            self.ends.data = self.mark_ends(flight)
        if title is not None and isinstance(self.figure.title, Title):
            self.figure.title.text = title
        for item in self.figure.legend[0].items if self.figure.legend else []:
            item.visible = item.renderers[0].name in columns


def chart(y_label: str, height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None) -> figure:
    """An empty figure over time [s] with title, cursor, tap and save; ranges may be shared to link figures."""
    fig = figure(
        title=" ", height=height, sizing_mode="stretch_width", tools="xpan,xwheel_zoom,box_zoom,reset,save",
        x_axis_label="time [s]", y_axis_label=y_label, min_border_right=12, active_drag=None,
        x_range=x_range or Range1d(0.0, 1.0), y_range=y_range or Range1d(0.0, 1.0),
    )  # fmt: skip
    plain(fig)
    fig.tags = [CURSOR_TAG, OVER_TIME_TAG]
    fig.js_on_event("tap", CustomJS(args={"event": CLOCK_EVENT}, code=_CLOCK_CODE))
    fig.js_on_event("pan", CustomJS(args={"event": CLOCK_EVENT, "fig": fig}, code=_DRAG_CODE))
    return fig


def plain(fig: figure) -> None:
    """No logo, no frame, and a toolbar only while the pointer is over the figure."""
    fig.toolbar.logo = None
    fig.toolbar.autohide = True
    fig.toolbar_location = "above"  # beside the title: on the right, low figures have no room for all of it
    fig.outline_line_color = None


def empty(columns: Sequence[str]) -> ColumnDataSource:
    """A source with these columns and no rows."""
    return ColumnDataSource({name: [] for name in columns})


def add_csv(fig: figure, name: str, *sources: ColumnDataSource) -> None:
    """Add toolbar buttons that save the figure as `name`.png and .svg, and the sources, side by side, as .csv."""
    add_downloads(fig, name, *sources)


def add_lines(
    fig: figure, source: ColumnDataSource, x: str, lines: Sequence[tuple[str, str, str]]
) -> list[GlyphRenderer]:
    """Draw (column, label, colour) as lines with a hover and a legend above whose entries hide their line."""
    entries = []
    for column, label, colour in lines:
        glyph = fig.line(
            x, column, source=source, color=colour, line_width=2.2, line_join="round", line_dash=ink_dash(colour),
            name=column,
        )  # fmt: skip
        glyph.nonselection_glyph = None
        entries.append((label, [glyph]))
    tips = [(x.replace("_s", " [s]"), f"@{x}{{0.0}}"), ("", "$name: @$name{0.00}")]
    drawn = [glyphs[0] for _label, glyphs in entries]
    fig.add_tools(HoverTool(renderers=drawn, tooltips=tips, visible=False))
    add_legend(fig, entries)
    return drawn


def missile_label(number: int, missiles: Sequence[int]) -> str:
    """How a missile is called in a legend: shorter where more than four have to stand in one row."""
    return f"missile {number}" if len(missiles) <= 4 else f"m{number}"


def add_legend(fig: figure, entries: Sequence[tuple[str, list[Any]]]) -> None:
    """One row of legend entries above the plot; a click hides what an entry names."""
    legend = Legend(items=list(entries), orientation="horizontal", click_policy="hide", padding=0, margin=2)
    fig.add_layout(legend, "above")


def dotted(fig: figure, *heights: float) -> None:
    """Horizontal dotted reference lines."""
    for height in heights:
        fig.add_layout(Span(location=height, dimension="width", line_dash="dotted", line_color=NEUTRAL, line_width=1.5))
