"""Speeds over time: evader, interceptor and every missile."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, empty, missile_label, thin_index
from layouts.theme import INTERCEPTOR, POLICY_A, missile_colour
from sim.trajectory import Trajectory


def speed_columns(trajectory: Trajectory) -> Columns:
    """`time_s`, `evader_m_s`, `interceptor_m_s`, `missile_k_m_s`; NaN when missile k is not in flight."""
    index = thin_index(len(trajectory.time_s))
    columns: Columns = {
        "time_s": trajectory.time_s[index],
        "evader_m_s": trajectory.evader.speed_m_s[index],
        "interceptor_m_s": trajectory.interceptor.speed_m_s[index],
    }
    for track in trajectory.missiles:
        speed = np.where(np.isfinite(track.position_m[:, 0]), track.speed_m_s, np.nan)
        columns[f"missile_{track.number}_m_s"] = speed[index]
    return columns


def speed_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None,
    evader_colour: str = POLICY_A,
) -> FlightChart:  # fmt: skip
    """Speeds [m/s] over time [s]."""
    lines = [("evader_m_s", "evader", evader_colour), ("interceptor_m_s", "interceptor", INTERCEPTOR)]
    lines += [(f"missile_{m}_m_s", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    fig = chart("speed [m/s]", height, x_range, y_range)
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "speeds", source)
    return FlightChart(fig, source, speed_columns)
