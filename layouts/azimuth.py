"""Missile azimuth over time (Fig. 12): where the evader sees each missile from its nose, with ±90° lines."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, FixedTicker, Range1d
from bokeh.plotting import figure
from numpy.typing import NDArray

from layouts.chart import Columns, add_csv, add_lines, chart, dotted, thin_index
from layouts.theme import missile_colour
from sim.trajectory import MissileTrack, Trajectory
from sim.world import Fate

HALF_TURN_DEG = 180.0


def azimuth_columns(trajectory: Trajectory) -> Columns:
    """`time_s` and `missile_k_deg` in (-180, 180], NaN when k is not in flight; gaps where one wraps."""
    index = thin_index(len(trajectory.time_s))
    columns: Columns = {"time_s": trajectory.time_s[index]}
    for track in trajectory.missiles:
        columns[f"missile_{track.number}_deg"] = np.degrees(track.azimuth_rad[index])
    return wrap_gaps(columns)


def wrap_gaps(columns: Columns) -> Columns:
    """Insert a row between samples where an angle [deg] jumps by more than half a turn, to break its line.

    In the new row the time and the angles that did not jump are the mean of their neighbours.
    """
    names = list(columns)[1:]
    jumps = {name: np.flatnonzero(np.abs(np.diff(columns[name])) > HALF_TURN_DEG) for name in names}
    rows = np.unique(np.concatenate([*jumps.values(), np.empty(0, dtype=np.intp)]).astype(np.intp))
    filled: Columns = {}
    for name, values in columns.items():
        middle = (values[rows] + values[rows + 1]) / 2.0
        middle[np.isin(rows, jumps.get(name, rows[:0]))] = np.nan
        filled[name] = np.insert(values, rows + 1, middle)
    return filled


def azimuth_figure(
    trajectory: Trajectory, title: str, height: int = 240, x_range: Range1d | None = None
) -> figure:
    """Azimuth of every missile [deg] over time [s], left of the nose positive; o evaded, x hit."""
    source = ColumnDataSource(azimuth_columns(trajectory))
    y_range = Range1d(-HALF_TURN_DEG, HALF_TURN_DEG, bounds=(-HALF_TURN_DEG, HALF_TURN_DEG))
    fig = chart(title, "azimuth [deg]", height, x_range, y_range)
    fig.yaxis.ticker = FixedTicker(ticks=[-180, -90, 0, 90, 180])
    dotted(fig, -90.0, 90.0)
    lines = [
        (f"missile_{m.number}_deg", f"missile {m.number}", missile_colour(m.number))
        for m in trajectory.missiles
    ]
    add_lines(fig, source, "time_s", lines)
    for track in trajectory.missiles:
        _mark_end(fig, trajectory.time_s, track)
    add_csv(fig, "azimuth", source)
    return fig


def _mark_end(fig: figure, time_s: NDArray[np.floating], track: MissileTrack) -> None:
    flown = np.flatnonzero(np.isfinite(track.azimuth_rad))
    if flown.size == 0 or track.fate not in (Fate.EVADED, Fate.HIT):
        return
    last, hit = flown[-1], track.fate == Fate.HIT
    fig.scatter(
        [float(time_s[last])],
        [float(np.degrees(track.azimuth_rad[last]))],
        marker="x" if hit else "circle",
        size=11 if hit else 7,
        line_width=2.5 if hit else 1.5,
        color=missile_colour(track.number),
        fill_alpha=0.0,
    )
