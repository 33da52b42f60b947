"""Survival around the evader, to point at and to click: launch range outwards, aspect around, its nose up."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS, GlyphRenderer, HoverTool, Range1d, Title
from bokeh.plotting import figure

from layouts.chart import add_csv, empty, plain
from layouts.survival import Values, edges, survival_colour

COLUMNS = (
    "launch_range_km", "aspect_deg", "survived", "closest_m", "inner", "outer", "start", "end", "colour", "words",
)  # fmt: skip
RING_COLUMNS = ("radius", "label", "x", "y")
RING_KM = 20.0
TITLE_HEIGHT = 32
_CLICK = """
const range = Math.hypot(cb_obj.x, cb_obj.y) * 1000;
const aspect = Math.atan2(-cb_obj.x, cb_obj.y) * 180 / Math.PI;
const data = source.data, ranges = data.launch_range_km, aspects = data.aspect_deg;
let best = -1, least = Infinity;
for (let i = 0; i < ranges.length; i++) {
  if (range / 1000 < data.inner[i] || range / 1000 >= data.outer[i]) continue;
  const apart = Math.abs(((aspect - aspects[i]) % 360 + 540) % 360 - 180);
  if (apart < least) { least = apart; best = i; }
}
if (best >= 0 && figure.tags.length) {
  const theme = new URLSearchParams(window.location.search).get("theme");
  const shot = `&shot=${Math.round(ranges[best] * 1000)},${aspects[best]}`;
  window.location.assign(figure.tags[0] + shot + (theme ? `&theme=${theme}` : ""));
}
"""


@dataclass(frozen=True)
class Shots:
    """What became of one missile fired at once, over R launch ranges and A aspects."""

    range_m: Values
    aspect_deg: Values
    survived: Values
    """Share `[R, A]` of the shots."""
    closest_m: Values
    """Mean closest approach `[R, A]` [m]; NaN where none was fired."""


@dataclass(frozen=True)
class SurvivalChart:
    """A figure changed in place by `show`."""

    figure: figure
    source: ColumnDataSource
    rings: ColumnDataSource
    evader: GlyphRenderer
    """Seen where there is something around it."""

    def show(self, shots: Shots, title: str, address: str) -> None:
        """Show a map; a click on a cell opens `address` with `&shot=RANGE,ASPECT` [m, deg] behind it."""
        self.source.data = cell_columns(shots)
        outmost = float(edges(shots.range_m / 1e3)[-1])
        for axis in (self.figure.x_range, self.figure.y_range):
            axis.update(start=-1.06 * outmost, end=1.06 * outmost)
        rings = np.arange(RING_KM, outmost, RING_KM)
        self.rings.data = {"radius": rings, "label": [f"{ring:g} km" for ring in rings], "x": rings * 0, "y": -rings}
        self.evader.visible = True
        self._name(title, [address])

    def clear(self, title: str) -> None:
        """Show nothing, and why."""
        self.source.data, self.rings.data = dict(empty(COLUMNS).data), dict(empty(RING_COLUMNS).data)
        self.evader.visible = False
        self._name(title, [])

    def _name(self, title: str, tags: list[str]) -> None:
        assert isinstance(self.figure.title, Title)
        self.figure.title.text, self.figure.tags = title, tags


def survival_chart(name: str, size: int) -> SurvivalChart:
    """An empty map, so many pixels wide; its CSV is called `survival-` and the name."""
    fig = figure(
        title=" ", width=size, height=size + TITLE_HEIGHT, sizing_mode="fixed", min_border=0, x_range=Range1d(-1, 1),
        y_range=Range1d(-1, 1), tools="save", active_drag=None,
    )  # fmt: skip
    plain(fig)
    fig.axis.visible = fig.grid.visible = False
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    source, rings = empty(COLUMNS), empty(RING_COLUMNS)
    cells = fig.annular_wedge(
        0.0, 0.0, inner_radius="inner", outer_radius="outer", start_angle="start", end_angle="end", source=source,
        fill_color="colour", line_color="colour", line_width=0.5,
    )  # fmt: skip
    fig.circle(0.0, 0.0, radius="radius", source=rings, fill_alpha=0.0, line_color="white", line_alpha=0.55)
    fig.text(
        "x", "y", "label", source=rings, text_color="white", text_font_size="11px", text_align="center",
        text_baseline="top",
    )  # fmt: skip
    evader = fig.scatter(0.0, 0.0, marker="triangle", size=13, color="white", line_color="black", visible=False)
    fig.add_tools(HoverTool(renderers=[cells], tooltips=[("", "@words")], visible=False))
    fig.js_on_event("tap", CustomJS(args={"source": source, "figure": fig}, code=_CLICK))
    add_csv(fig, f"survival-{name}", source)
    return SurvivalChart(fig, source, rings, evader)


def cell_columns(shots: Shots) -> dict[str, list]:
    """Cells as wedges: radii [km], angles [rad] from the x axis of a picture in which the nose points up."""
    outward, around = edges(shots.range_m / 1e3), np.radians(edges(shots.aspect_deg))
    rows = []
    for i, distance_m in enumerate(shots.range_m):
        for j, aspect in enumerate(shots.aspect_deg):
            share, miss_m = float(shots.survived[i, j]), float(shots.closest_m[i, j])
            angles = (float(around[k]) + math.pi / 2.0 for k in (j, j + 1))
            words = f"{distance_m / 1e3:.1f} km, {_side(float(aspect))}: {_fate(share, miss_m)}; click to fly it"
            inner = max(float(outward[i]), 0.0)
            rows.append(
                (distance_m / 1e3, float(aspect), share, miss_m, inner, float(outward[i + 1]), *angles,
                 survival_colour(share), words)
            )  # fmt: skip
    return {name: [row[k] for row in rows] for k, name in enumerate(COLUMNS)}


def _side(aspect_deg: float) -> str:
    if aspect_deg == 0.0:
        return "ahead"
    return "behind" if abs(aspect_deg) == 180.0 else f"{abs(aspect_deg):g}° {'left' if aspect_deg > 0.0 else 'right'}"


def _fate(share: float, miss_m: float) -> str:
    if 0.0 < share < 1.0:
        return f"survived {100.0 * share:.0f} %"
    return "shot down" if share == 0.0 else f"survived, missed by {miss_m:,.0f} m"
