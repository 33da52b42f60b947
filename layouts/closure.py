"""How fast distances shrink: from the evader to every missile and to the interceptor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d
from numpy.typing import NDArray

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, dotted, empty, missile_label, thin_index
from layouts.theme import INTERCEPTOR, missile_colour
from sim.trajectory import Trajectory


def interceptor_range_m(trajectory: Trajectory) -> NDArray[np.float64]:
    """Distance from the evader to the interceptor `[T]` [m]."""
    return np.linalg.norm(trajectory.interceptor.position_m - trajectory.evader.position_m, axis=1)


def closure_m_s(range_m: NDArray[np.floating], time_s: NDArray[np.floating]) -> NDArray[np.float64]:
    """Rate `[T]` [m/s] at which a distance `[T]` shrinks, negative when it grows; NaN where the distance is."""
    closure = np.full(len(range_m), np.nan)
    known = np.flatnonzero(np.isfinite(range_m))
    if len(known) > 1:  # a missile flies once, so the known samples are neighbours
        closure[known] = -np.gradient(range_m[known], time_s[known])
    return closure


def closure_columns(trajectory: Trajectory) -> Columns:
    """`time_s`, `interceptor_closure_m_s` and `missile_k_closure_m_s`, NaN when k is not in flight."""
    index, time = thin_index(len(trajectory.time_s)), trajectory.time_s
    columns: Columns = {
        "time_s": time[index],
        "interceptor_closure_m_s": closure_m_s(interceptor_range_m(trajectory), time)[index],
    }
    for track in trajectory.missiles:
        columns[f"missile_{track.number}_closure_m_s"] = closure_m_s(track.range_m, time)[index]
    return columns


def closure_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None
) -> FlightChart:
    """Closure [m/s] over time [s]; below 0 the distance grows."""
    lines = [("interceptor_closure_m_s", "interceptor", INTERCEPTOR)]
    lines += [(f"missile_{m}_closure_m_s", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    fig = chart("closure [m/s]", height, x_range, y_range)
    dotted(fig, 0.0)
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "closures", source)
    return FlightChart(fig, source, closure_columns)
