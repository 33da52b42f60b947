"""Two flights in one figure: the curves of the second are dotted over those of the first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, GlyphRenderer, HoverTool, Line, Quad

from layouts.chart import FlightChart, empty
from layouts.theme import DASHED, POLICY_A, POLICY_B
from sim.trajectory import Trajectory

DOTS, DASH_DOTS = [2, 3], [8, 3, 2, 3]
"""How the second flight is drawn: dotted, and dash-dotted where the first one is dashed."""


@dataclass(frozen=True)
class OverlaidChart:
    """A figure of one flight with a second one over it, on the same axes; the legend's entries hide both."""

    first: FlightChart
    source: ColumnDataSource
    """What the second flight's curves are drawn from."""
    ends: ColumnDataSource | None

    def show(self, a: Trajectory, b: Trajectory, title: str) -> None:
        """Show these two flights of one task."""
        self.first.show(a, title)
        columns = self.first.columns(b)
        nothing = np.full(len(next(iter(columns.values()))), np.nan)
        self.source.data = {name: columns.get(name, nothing) for name in self.source.column_names}
        if self.ends is not None and self.first.mark_ends is not None:
            self.ends.data = self.first.mark_ends(b)


def overlay(first: FlightChart) -> OverlaidChart:
    """Make room for a second flight in a figure made for one."""
    source = empty(first.source.column_names)
    ends = None if first.ends is None else empty(first.ends.column_names)
    twins = {}
    for renderer in [
        r for r in first.figure.renderers if isinstance(r, GlyphRenderer) and not isinstance(r.glyph, Quad)
    ]:
        # What belongs to neither, such as the exit on the map, is there once.
        for own, other in ((first.source, source), (first.ends, ends)):
            if other is not None and renderer.data_source is own:
                twins[renderer] = _twin(first, renderer, other)
    for item in first.figure.legend[0].items:
        item.renderers = [*item.renderers, *(twins[r] for r in item.renderers if r in twins)]
    for hover in first.figure.select(HoverTool):
        hover.renderers = [*hover.renderers, *(twins[r] for r in hover.renderers if r in twins)]
    return OverlaidChart(first, source, ends)


def _twin(first: FlightChart, renderer: GlyphRenderer, data: ColumnDataSource) -> GlyphRenderer:
    glyph: Any = renderer.glyph.clone()
    if isinstance(glyph, Line):
        glyph.line_dash = DASH_DOTS if str(glyph.line_color) in DASHED else DOTS
        if str(glyph.line_color) == POLICY_A:
            glyph.line_color = POLICY_B
    twin = first.figure.add_glyph(data, glyph)
    twin.name, twin.nonselection_glyph = renderer.name, None
    return twin
