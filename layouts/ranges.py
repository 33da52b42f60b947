"""Distances over time: from the evader to every missile and to the interceptor."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from layouts.chart import Columns, add_csv, add_lines, chart, largest, thin_index
from layouts.theme import INTERCEPTOR, missile_colour
from sim.trajectory import Trajectory


def range_columns(trajectory: Trajectory) -> Columns:
    """`time_s`, `interceptor_km` and `missile_k_km`, NaN when k is not in flight; minima are kept."""
    closest = [int(np.nanargmin(m.range_m)) for m in trajectory.missiles if np.isfinite(m.range_m).any()]
    index = thin_index(len(trajectory.time_s), closest)
    gap_m = np.linalg.norm(trajectory.interceptor.position_m - trajectory.evader.position_m, axis=1)
    columns: Columns = {"time_s": trajectory.time_s[index], "interceptor_km": gap_m[index] / 1e3}
    for track in trajectory.missiles:
        columns[f"missile_{track.number}_km"] = track.range_m[index] / 1e3
    return columns


def range_figure(
    trajectory: Trajectory,
    title: str,
    height: int = 240,
    x_range: Range1d | None = None,
    y_range: Range1d | None = None,
) -> figure:
    """Ranges [km] over time [s]."""
    source = ColumnDataSource(range_columns(trajectory))
    fig = chart(title, "range [km]", height, x_range, y_range)
    missiles = [
        (f"missile_{m.number}_km", f"missile {m.number}", missile_colour(m.number))
        for m in trajectory.missiles
    ]
    add_lines(fig, source, "time_s", [("interceptor_km", "interceptor", INTERCEPTOR), *missiles])
    add_csv(fig, "ranges", source)
    return fig


def longest_range_km(*trajectories: Trajectory) -> float:
    """Largest distance in any of the flights [km], to give their figures one scale."""
    return largest(*(range_columns(t) for t in trajectories))
