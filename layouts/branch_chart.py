"""A branch over the flight that it leaves: azimuths, the closest missile, ground tracks; the original is dotted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, FixedTicker, GlyphRenderer, Range1d, Span, Title
from bokeh.plotting import figure
from numpy.typing import NDArray

from layouts.azimuth import HALF_TURN_DEG, azimuth_columns
from layouts.chart import Columns, FlightChart, add_csv, add_legend, chart, dotted, empty, missile_label, thin_index
from layouts.map2d import map_chart, map_columns
from layouts.theme import BRANCH, POLICY_A, ink_dash, missile_colour
from sim.scenario import Scenario
from sim.trajectory import Trajectory

KM = 1e-3
MARGIN = 1.05
AROUND_S = 20.0
"""Time shown before the moment at which a branch leaves its original, and after the last missile of both."""
PREFIX = "branch_"


@dataclass(frozen=True)
class Overlay:
    """One figure with a curve, or several, of the original and of the branch; `names` are the columns of both."""

    figure: figure
    original: ColumnDataSource
    branch: ColumnDataSource
    names: tuple[str, ...]
    moment: Span

    def show(self, original: Columns, branch: Columns, from_s: float, title: str) -> None:
        """Draw these columns, the branch's only from its moment on; a column that is not there stays empty."""
        later = {name: values[branch["time_s"] >= from_s - 1e-6] for name, values in branch.items()}
        for source, columns, prefix in ((self.original, original, ""), (self.branch, later, PREFIX)):
            nothing = np.full(len(columns["time_s"]), np.nan)
            source.data = {prefix + name: columns.get(name, nothing) for name in self.names}
        self.moment.location = from_s
        if isinstance(self.figure.title, Title):
            self.figure.title.text = title
        for item in self.figure.legend[0].items if self.figure.legend else []:
            item.visible = item.renderers[0].name in original


class BranchCharts:
    """The figures of one scenario; `show` changes them in place."""

    def __init__(self, scenario: Scenario, height: int = 240) -> None:
        self.scenario = scenario
        self._missiles = range(1, scenario.launch.missiles + 1)
        self._time = Range1d(0.0, 1.0)
        self._azimuth = _azimuth_overlay(self._missiles, height, self._time)
        self._nearest, self._own = _nearest_overlay(height, self._time)
        self._map = map_chart(scenario.battlefield, self._missiles, height, BRANCH)
        self._track, self._way = _track_overlay(self._map)
        # Three figures side by side have no room for its many names; the colours are those of the chips above.
        self._map.figure.legend.visible = False
        self.figures = (self._azimuth.figure, self._nearest.figure, self._map.figure)

    def show(self, original: Trajectory, branch: Trajectory, from_s: float, letter: str, colour: str) -> None:
        """Compare a branch with its original, flight `letter` in `colour`, which it leaves at `from_s` [s]."""
        end_s, low_s = max(original.duration_s, branch.duration_s), max(from_s - AROUND_S, 0.0)
        high_s = min(max(_last_missile_s(original), _last_missile_s(branch), from_s + AROUND_S) + AROUND_S, end_s)
        self._time.update(start=low_s, end=high_s, reset_start=low_s, reset_end=high_s, bounds=(0.0, end_s))
        how = f"branch solid, {letter} dotted"
        self._azimuth.show(azimuth_columns(original), azimuth_columns(branch), from_s, f"Azimuths · {how}")
        near = nearest_columns(original), nearest_columns(branch)
        self._nearest.show(*near, from_s, f"Closest missile · {how}")
        top = _largest(*near, from_s=low_s) * MARGIN
        self._nearest.figure.y_range.update(start=0.0, end=top, reset_end=top, bounds=(0.0, top))
        for line in (self._own, self._way):
            line.glyph.line_color = colour
        self._map.show(branch, f"Ground tracks · {how}")
        track = map_columns(original)
        self._track.data = {f"original_{axis}_km": track[f"evader_{axis}_km"] for axis in "xy"}


def nearest_columns(flight: Trajectory) -> Columns:
    """`time_s` and `closest_km`, the distance of the closest missile in flight; NaN when none flies."""
    index = thin_index(len(flight.time_s))
    ranges = np.array([track.range_m[index] for track in flight.missiles]).reshape(-1, len(index))
    return {"time_s": flight.time_s[index], "closest_km": _smallest(ranges) * KM}


def _last_missile_s(flight: Trajectory) -> float:
    """When the last missile of a flight ended, or the flight while one flew [s]; 0 without any."""
    ends = [m.end_s if np.isfinite(m.end_s) else flight.duration_s for m in flight.missiles if np.isfinite(m.launch_s)]
    return max(ends, default=0.0)


def _smallest(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Smallest number of every column `[n, T]`, NaN where there is none."""
    finite = np.where(np.isfinite(values), values, np.inf)
    smallest = finite.min(axis=0, initial=np.inf)
    return np.where(np.isfinite(smallest), smallest, np.nan)


def _largest(*tables: Columns, from_s: float) -> float:
    seen = np.concatenate([table["closest_km"][table["time_s"] >= from_s] for table in tables])
    return float(np.nanmax(seen, initial=1.0))


def _azimuth_overlay(missiles: Sequence[int], height: int, time: Range1d) -> Overlay:
    limits = (-HALF_TURN_DEG, HALF_TURN_DEG)
    fig = chart("azimuth [deg]", height, time, Range1d(*limits, bounds=limits))
    fig.yaxis.ticker = FixedTicker(ticks=[-180, -90, 0, 90, 180])
    dotted(fig, -90.0, 90.0)
    overlay = _overlay(fig, ("time_s", *(f"missile_{m}_deg" for m in missiles)), "branch-azimuth")
    entries = []
    for missile in missiles:
        ink = missile_colour(missile)
        lines = _lines(overlay, f"missile_{missile}_deg", (ink, ink))
        entries.append((missile_label(missile, missiles), list(lines)))
    add_legend(fig, entries)
    return overlay


def _nearest_overlay(height: int, time: Range1d) -> tuple[Overlay, GlyphRenderer]:
    fig = chart("range [km]", height, time)
    overlay = _overlay(fig, ("time_s", "closest_km"), "branch-range")
    original, _branch = _lines(overlay, "closest_km", (POLICY_A, BRANCH))
    return overlay, original


def _track_overlay(below: FlightChart) -> tuple[ColumnDataSource, GlyphRenderer]:
    source = empty(["original_x_km", "original_y_km"])
    line = below.figure.line(
        "original_x_km",
        "original_y_km",
        source=source,
        color=POLICY_A,
        line_width=2.2,
        line_dash="dotted",
        name="original",
    )
    return source, line


def _overlay(fig: figure, names: tuple[str, ...], file: str) -> Overlay:
    moment = Span(location=0.0, dimension="height", line_color=BRANCH, line_width=1.5, line_dash="dashed")
    fig.add_layout(moment)
    original, branch = empty(names), empty([PREFIX + name for name in names])
    add_csv(fig, file, original, branch)
    return Overlay(fig, original, branch, names, moment)


def _lines(overlay: Overlay, column: str, inks: tuple[str, str]) -> tuple[GlyphRenderer, GlyphRenderer]:
    look = {"line_width": 2.2, "line_join": "round"}
    original = overlay.figure.line(
        "time_s", column, source=overlay.original, color=inks[0], name=column, line_dash="dotted", **look
    )
    branch = overlay.figure.line(
        PREFIX + "time_s", PREFIX + column, source=overlay.branch, color=inks[1], name=column,
        line_dash=ink_dash(inks[1]), **look,
    )  # fmt: skip
    return original, branch
