"""Reward terms of Eq. 9 as they are paid over a flight, and summed up: final goal, every missile, time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d

from layouts.chart import Columns, FlightChart, Marks, add_csv, add_lines, chart, empty, missile_label, thin_index
from layouts.theme import NEUTRAL, missile_colour
from sim.trajectory import Trajectory

GOAL_INK, TIME_INK = "#b5623c", "#8c8f1f"
PAID_COLUMNS = ("paid_time_s", "paid_total", "paid_text", "paid_colour")


def reward_columns(trajectory: Trajectory) -> Columns:
    """Running sums: `time_s`, `goal`, `missile_k` of the unmasked missiles, `time` and `total`.

    A decision's reward is shown when the decision has been carried out, one decision step after it was taken.
    """
    columns = reward_sums(trajectory)
    index = thin_index(len(columns["time_s"]))
    return {name: values[index] for name, values in columns.items()}


def reward_sums(trajectory: Trajectory) -> Columns:
    """The same for every one of the K decision steps."""
    sums = np.cumsum(trajectory.reward_terms, axis=0)
    step_s = trajectory.task.scenario.rules.step_s
    ended = np.minimum(trajectory.step_time_s + step_s, trajectory.time_s[-1])
    columns: Columns = {"time_s": ended, "goal": sums[:, 0]}
    for number in trajectory.task.missiles:
        columns[f"missile_{number}"] = sums[:, number]
    return columns | {"time": sums[:, -1], "total": sums.sum(axis=1)}


def paid_columns(trajectory: Trajectory) -> Marks:
    """Every payment but that of time: when [s], the return with it, how much in words, and its ink."""
    terms, sums = trajectory.reward_terms, reward_sums(trajectory)
    rows = []
    for step, term in zip(*np.nonzero(terms[:, :-1]), strict=True):
        ink = missile_colour(int(term)) if term else GOAL_INK
        rows.append((float(sums["time_s"][step]), float(sums["total"][step]), f"{terms[step, term]:+.0f}", ink))
    return {name: [row[i] for row in rows] for i, name in enumerate(PAID_COLUMNS)}


def reward_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None
) -> FlightChart:
    """Cumulative reward terms and their total, the episode return, over time [s]."""
    lines = [("total", "return", NEUTRAL), ("goal", "goal", GOAL_INK), ("time", "time", TIME_INK)]
    lines += [(f"missile_{m}", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    paid = empty(PAID_COLUMNS)
    fig = chart("reward paid so far", height, x_range, y_range)
    add_lines(fig, source, "time_s", lines)
    fig.scatter("paid_time_s", "paid_total", source=paid, size=7, color="paid_colour")
    fig.text(
        "paid_time_s", "paid_total", text="paid_text", source=paid, text_color="paid_colour", text_font_size="12px",
        text_font_style="bold", text_align="right", x_offset=-7, y_offset=-3,
    )  # fmt: skip
    add_csv(fig, "rewards", source)
    return FlightChart(fig, source, reward_columns, paid, paid_columns)
