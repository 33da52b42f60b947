"""The bars of the Compare page: success, return (Fig. 13) and causes of failure, with one legend for all three."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
from bokeh.events import Tap

from layouts.comparison_bars import Bar, BarChart, cause_chart, places, return_chart, success_chart
from workbench.comparison.figures import CellFigures
from workbench.comparison.grid import Cell, Grid
from workbench.pages.compare_words import COMPARE_CSS, legend

HEIGHT = 270
SIDE_BY_SIDE = """
:host { display: grid !important; grid-template-columns: repeat(auto-fit, minmax(min(100%, 400px), 1fr));
  gap: 10px 16px; height: auto !important }
"""


class CompareBars:
    """Three figures that are changed in place; a click on a bar calls `choose` with policy and task."""

    def __init__(self, choose: Callable[[str, str], None]) -> None:
        self._choose = choose
        self._charts: tuple[BarChart, ...] = (success_chart(HEIGHT), return_chart(HEIGHT), cause_chart(HEIGHT))
        self._placed: list[tuple[float, float, str, str]] = []
        self.legend = pn.pane.HTML("", stylesheets=[COMPARE_CSS], margin=0, sizing_mode="stretch_width")
        panes = []
        for chart in self._charts:
            chart.figure.on_event(Tap, self._tap)
            panes.append(pn.pane.Bokeh(chart.figure, sizing_mode="stretch_width", margin=0))
        self.figures = pn.Row(
            *panes, sizing_mode="stretch_width", margin=0, stylesheets=[SIDE_BY_SIDE], css_classes=["tour-compare"]
        )

    def show(self, grid: Grid, labels: Mapping[str, str], inks: Mapping[str, str]) -> None:
        """Show what is known of every cell."""
        bars, returns = bars_of(grid, labels, inks)
        for chart, shown in zip(self._charts, (bars, returns, bars), strict=True):
            chart.show(grid.tasks, shown)
        self._placed = [
            (x, width, policy, task)
            for (x, width, _), (task, policy) in zip(places(grid.tasks, bars), _keys(grid), strict=True)
        ]
        elsewhere = any(bar.elsewhere and bar.value is not None for bar in bars)
        shown = {policy: labels[policy] for policy in grid.policies}
        causes = sorted({cause for bar in bars for cause in bar.causes or {}})
        self.legend.object = legend(shown, inks, elsewhere, causes)

    def _tap(self, event: Any) -> None:
        for x, width, policy, task in self._placed:
            if abs(event.x - x) <= width / 2.0:
                self._choose(policy, task)


def bars_of(grid: Grid, labels: Mapping[str, str], inks: Mapping[str, str]) -> tuple[list[Bar], list[Bar]]:
    """Success with causes, and return, of every cell, task by task."""
    cells = [grid.cell(policy, task) for task, policy in _keys(grid)]
    bars = [_bar(cell, labels[cell.entry.spec], inks[cell.entry.spec]) for cell in cells]
    return bars, [_return(bar, cell.figures) for bar, cell in zip(bars, cells, strict=True)]


def _keys(grid: Grid) -> list[tuple[str, str]]:
    return [(task, policy) for task in grid.tasks for policy in grid.policies]


def _bar(cell: Cell, label: str, ink: str) -> Bar:
    figures = cell.figures
    if figures is None:
        return Bar(cell.task.name, label, ink, None)
    low, high = (100.0 * bound for bound in figures.success_ci95)
    shares = {cause: 100.0 * count / figures.episodes for cause, count in figures.causes.items()}
    source = "shipped result set" if figures.shipped else "flown here"
    note = "; ".join(filter(None, [f"{figures.episodes} engagements, {source}", html.escape(cell.entry.note)]))
    return Bar(
        cell.task.name, label, ink, 100.0 * figures.success_rate, low, high, shares, figures.causes,
        bool(cell.entry.note), note,
    )  # fmt: skip


def _return(bar: Bar, figures: CellFigures | None) -> Bar:
    if figures is None:
        return bar
    low, high = figures.return_ci95 or (None, None)
    return Bar(bar.task, bar.policy, bar.colour, figures.mean_return, low, high, None, None, bar.elsewhere, bar.note)
