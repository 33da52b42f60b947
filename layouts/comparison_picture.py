"""The bars of a comparison as a sheet for a paper or a talk (Fig. 13): success, return, causes of failure."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from layouts.comparison_bars import Bar, places
from layouts.comparison_inks import cause_ink, cause_words
from layouts.paper_sheet import FAINT, INK, plain, sheet

HEIGHT_IN, PANEL_IN = 4.6, 5.4
HATCH = "///"


def comparison_picture(tasks: Sequence[str], success: Sequence[Bar], returns: Sequence[Bar], caption: str) -> Figure:
    """Three panels side by side; hatched bars fly something else than they were trained for.

    Args:
        tasks: their names, one per group of bars.
        success: success rates [%] and causes of failure.
        returns: mean returns.
        caption: what stands below.
    """
    figure = sheet("Policies compared", caption, (3.0 * PANEL_IN, HEIGHT_IN))
    grid = figure.add_gridspec(1, 3, left=0.04, right=0.99, top=0.76, bottom=0.2, wspace=0.14)
    first, second, third = (figure.add_subplot(cell) for cell in grid)
    _bars(first, tasks, success, "success rate [%]")
    first.set(ylim=(0.0, 112.0), yticks=range(0, 101, 20))
    _bars(second, tasks, returns, "mean return")
    causes = _causes(third, tasks, success)
    handles = [Patch(color=colour, label=policy) for policy, colour in _policies(success).items()]
    handles += [Patch(color=cause_ink(cause), label=cause_words(cause)) for cause in causes]
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.006, 0.92), ncols=min(len(handles), 8), frameon=False,
        fontsize=8.5, labelcolor=INK,
    )  # fmt: skip
    return figure


def _bars(axes: Axes, tasks: Sequence[str], bars: Sequence[Bar], label: str) -> None:
    for x, width, bar in places(tasks, bars):
        if bar.value is None:
            continue
        axes.bar(x, bar.value, width, color=bar.colour, hatch=HATCH if bar.elsewhere else None, edgecolor="white",
                 linewidth=0.0)  # fmt: skip
        top = bar.value if bar.high is None else bar.high
        if bar.low is not None:
            axes.plot([x, x], [bar.low, top], color=INK, linewidth=1.2)
        axes.annotate(f"{bar.value:.1f}", (x, top), (0, 2), textcoords="offset points", ha="center", fontsize=6.5,
                      color=FAINT)  # fmt: skip
    _finish(axes, tasks, label)


def _causes(axes: Axes, tasks: Sequence[str], bars: Sequence[Bar]) -> list[str]:
    """Stacked bars; the causes that occur."""
    found: dict[str, None] = {}
    for x, width, bar in places(tasks, bars):
        bottom = 0.0
        for cause, share in (bar.causes or {}).items():
            axes.bar(x, share, width, bottom, color=cause_ink(cause))
            bottom += share
            found[cause] = None
    _finish(axes, tasks, "causes of failure [%]")
    return list(found)


def _finish(axes: Axes, tasks: Sequence[str], label: str) -> None:
    axes.set_xticks(range(len(tasks)), tasks, rotation=0 if len(tasks) <= 6 else 30)
    axes.set_ylabel(label)
    plain(axes)
    axes.grid(axis="x", visible=False)


def _policies(bars: Sequence[Bar]) -> dict[str, str]:
    return {bar.policy: bar.colour for bar in bars}
