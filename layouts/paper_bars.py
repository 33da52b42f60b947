"""Return and success of two policies on the tasks of the chain, as bars (Fig. 13)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from layouts.paper_inks import ink
from layouts.paper_panels import WIDTH, Bars
from layouts.paper_sheet import FAINT, INK, plain, sheet

SIZE_IN = (11.6, 4.9)


def policy_bars(
    tasks: Sequence[str], bars: Sequence[Bars], dots: Bars | None, references: dict[int, float], caption: str
) -> Figure:
    """Fig. 13: episode return (left) and success rate (right) by task, with intervals.

    Args:
        tasks: their names, one per group of bars.
        bars: one or two policies, side by side.
        dots: another policy, drawn as a mark in the middle of each group.
        references: success rates to mark, by the position of the task; here the paper's.
        caption: what stands below.
    """
    figure = sheet("Fig. 13  SubMas-RL and the dragging expert", caption, SIZE_IN)
    grid = figure.add_gridspec(1, 2, left=0.06, right=0.985, top=0.8, bottom=0.24, wspace=0.13)
    left, right = (figure.add_subplot(cell) for cell in grid)
    for position, one in enumerate(bars):
        places = np.arange(len(tasks)) + (position - (len(bars) - 1) / 2.0) * (WIDTH + 0.02)
        _bars(left, places, one.returns, one, "{:.0f}")
        _bars(right, places, [None if s is None else 100.0 * s for s in one.success], one, "{:.1f}")
        _whiskers(right, places, one)
    if dots is not None:
        for axes, values, scale in ((left, dots.returns, 1.0), (right, dots.success, 100.0)):
            shown = [(place, scale * value) for place, value in enumerate(values) if value is not None]
            axes.plot(
                *zip(*shown, strict=True), "D", color="white", markeredgecolor=INK, markersize=6, label=dots.label
            )
    for place, share in references.items():
        label = "the paper's expert" if place == min(references) else None
        right.plot([place + 0.02, place + 0.42], [100.0 * share] * 2, color=INK, linewidth=1.6, label=label)
    left.set_ylabel("episode return")
    right.set(ylabel="success rate [%]", ylim=(0.0, 112.0), yticks=range(0, 101, 20))
    for axes in (left, right):
        axes.set_xticks(range(len(tasks)), tasks)
        plain(axes)
        axes.grid(axis="x", visible=False)
    # Bars first: they are what the figure is about.
    entries = sorted(
        zip(*right.get_legend_handles_labels(), strict=True), key=lambda entry: isinstance(entry[0], Line2D)
    )
    handles, labels = zip(*entries, strict=True)
    figure.legend(
        handles, labels, loc="upper left", bbox_to_anchor=(0.01, 0.92), ncols=len(labels), frameon=False, fontsize=9.5,
        labelcolor=INK,
    )  # fmt: skip
    return figure


def _bars(axes: Axes, places: np.ndarray, values: Sequence[float | None], one: Bars, form: str) -> None:
    heights = [0.0 if value is None else value for value in values]
    axes.bar(places, heights, WIDTH, color=ink(one.algorithm), label=one.label)
    for place, value in zip(places, values, strict=True):
        words = "not run" if value is None else form.format(value)
        inside = value is not None and value > 0.15 * max(*heights, 1e-9)
        axes.annotate(
            words, (place, value or 0.0), (0, -4 if inside else 3), textcoords="offset points", ha="center",
            va="top" if inside else "bottom", fontsize=8, color="white" if inside else FAINT,
        )  # fmt: skip


def _whiskers(axes: Axes, places: np.ndarray, one: Bars) -> None:
    for place, interval in zip(places, one.interval, strict=True):
        if interval is not None:
            axes.plot([place, place], [100.0 * bound for bound in interval], color=INK, linewidth=1.3)
