"""Reward terms of Eq. 9 summed up over a flight: final goal, every missile, time."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from layouts.chart import Columns, add_csv, add_lines, chart, thin_index
from layouts.theme import NEUTRAL, SUCCESS, missile_colour
from sim.trajectory import Trajectory


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


def reward_figure(
    trajectory: Trajectory,
    title: str,
    height: int = 240,
    x_range: Range1d | None = None,
    y_range: Range1d | None = None,
) -> figure:
    """Cumulative reward terms and their total, the episode return, over time [s]."""
    source = ColumnDataSource(reward_columns(trajectory))
    fig = chart(title, "cumulative reward", height, x_range, y_range)
    lines = [("total", "return", NEUTRAL), ("goal", "goal", SUCCESS), ("time", "time", "#b08968")]
    lines += [
        (f"missile_{number}", f"missile {number}", missile_colour(number))
        for number in trajectory.task.missiles
    ]
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "rewards", source)
    return fig


def reward_span(*trajectories: Trajectory) -> tuple[float, float]:
    """Lowest and highest running sum of any of the flights, to give their figures one scale."""
    sums = [np.cumsum(t.reward_terms, axis=0) for t in trajectories]
    values = np.concatenate([np.concatenate([s.ravel(), s.sum(axis=1)]) for s in sums] + [np.zeros(1)])
    return float(values.min()), float(values.max())
