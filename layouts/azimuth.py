"""Missile azimuth over time (Fig. 12): where the evader sees each missile from its nose, with ±90° lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import FixedTicker, Range1d
from numpy.typing import NDArray

from layouts.chart import (
    Columns,
    FlightChart,
    Marks,
    add_csv,
    add_lines,
    chart,
    dotted,
    empty,
    missile_label,
    thin_index,
)
from layouts.theme import missile_colour
from sim.trajectory import MissileTrack, Trajectory
from sim.world import Fate

HALF_TURN_DEG = 180.0
END_COLUMNS = ("end_time_s", "end_azimuth_deg", "end_missile", "end_marker", "end_colour")


def azimuth_columns(trajectory: Trajectory) -> Columns:
    """`time_s` and `missile_k_deg` in (-180, 180], NaN when k is not in flight; gaps where one wraps."""
    index = thin_index(len(trajectory.time_s))
    columns: Columns = {"time_s": trajectory.time_s[index]}
    for track in trajectory.missiles:
        columns[f"missile_{track.number}_deg"] = np.degrees(_seen(track)[index])
    return wrap_gaps(columns)


def _seen(track: MissileTrack) -> NDArray[np.float64]:
    """Azimuth without the last instant of a hit, in which the missile passes the evader and the angle jumps."""
    seen = track.azimuth_rad.copy()
    if track.fate == Fate.HIT:
        seen[np.flatnonzero(np.isfinite(seen))[-1:]] = np.nan
    return seen


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


def azimuth_chart(missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None) -> FlightChart:
    """Azimuth [deg] of these missiles over time [s], left of the nose positive; ends: o evaded, x hit."""
    source, ends = empty(["time_s", *(f"missile_{m}_deg" for m in missiles)]), empty(END_COLUMNS)
    y_range = Range1d(-HALF_TURN_DEG, HALF_TURN_DEG, bounds=(-HALF_TURN_DEG, HALF_TURN_DEG))
    fig = chart("azimuth [deg]", height, x_range, y_range)
    fig.yaxis.ticker = FixedTicker(ticks=[-180, -90, 0, 90, 180])
    dotted(fig, -90.0, 90.0)
    add_lines(
        fig, source, "time_s", [(f"missile_{m}_deg", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    )
    fig.scatter(
        "end_time_s", "end_azimuth_deg", marker="end_marker", color="end_colour", source=ends, size=9, line_width=2,
        fill_alpha=0.0,
    )  # fmt: skip
    add_csv(fig, "azimuth", source)
    return FlightChart(fig, source, azimuth_columns, ends, end_columns)


def end_columns(trajectory: Trajectory) -> Marks:
    """Where each missile's curve ends: one row per missile that was evaded or hit."""
    rows = []
    for track in trajectory.missiles:
        flown = np.flatnonzero(np.isfinite(_seen(track)))
        if flown.size and track.fate in (Fate.EVADED, Fate.HIT):
            last, marker = flown[-1], "x" if track.fate == Fate.HIT else "circle"
            angle = float(np.degrees(track.azimuth_rad[last]))
            rows.append((float(trajectory.time_s[last]), angle, track.number, marker, missile_colour(track.number)))
    return {name: [row[i] for row in rows] for i, name in enumerate(END_COLUMNS)}
