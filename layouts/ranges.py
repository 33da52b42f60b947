"""Distances over time: from the evader to every missile and to the interceptor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, empty, missile_label, thin_index
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


def range_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None
) -> FlightChart:
    """Ranges [km] over time [s]."""
    lines = [("interceptor_km", "interceptor", INTERCEPTOR)]
    lines += [(f"missile_{m}_km", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    fig = chart("range [km]", height, x_range, y_range)
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "ranges", source)
    return FlightChart(fig, source, range_columns)
