"""Reward terms of Eq. 9 summed up over a flight: final goal, every missile, time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, empty, missile_label, thin_index
from layouts.theme import NEUTRAL, missile_colour
from sim.trajectory import Trajectory

GOAL_INK, TIME_INK = "#b5623c", "#8c8f1f"


def reward_columns(trajectory: Trajectory) -> Columns:
    """Running sums: `time_s`, `goal`, `missile_k` of the unmasked missiles, `time` and `total`.

    A decision's reward is shown when the decision has been carried out, one decision step after it was taken.
    """
    sums = np.cumsum(trajectory.reward_terms, axis=0)
    step_s = trajectory.task.scenario.rules.step_s
    ended = np.minimum(trajectory.step_time_s + step_s, trajectory.time_s[-1])
    index = thin_index(len(ended))
    columns: Columns = {"time_s": ended[index], "goal": sums[index, 0]}
    for number in trajectory.task.missiles:
        columns[f"missile_{number}"] = sums[index, number]
    return columns | {"time": sums[index, -1], "total": sums.sum(axis=1)[index]}


def reward_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None
) -> FlightChart:
    """Cumulative reward terms and their total, the episode return, over time [s]."""
    lines = [("total", "return", NEUTRAL), ("goal", "goal", GOAL_INK), ("time", "time", TIME_INK)]
    lines += [(f"missile_{m}", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    fig = chart("cumulative reward", height, x_range, y_range)
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "rewards", source)
    return FlightChart(fig, source, reward_columns)
