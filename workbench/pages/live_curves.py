"""The curves of the Live page: success, return and weights over all epochs, and the critic's loss."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import panel as pn
from bokeh.models import BasicTicker
from bokeh.plotting import figure

from layouts.chart import add_csv, add_lines
from layouts.learning_curves import LearningCurves, learning_curves
from layouts.theme import POLICY_B

HEIGHT = 250


class LiveCurves:
    """Four figures that share one epoch axis; `show` fills them in place."""

    def __init__(self) -> None:
        self._curves: LearningCurves = learning_curves(height=HEIGHT)
        figures = [self._curves.success, self._curves.returns, self._curves.weights, self._loss()]
        for each in figures:
            each.background_fill_alpha = each.border_fill_alpha = 0.0  # the panel's colour shows through
            each.xaxis[0].ticker = BasicTicker(min_interval=1)
        panes = [pn.pane.Bokeh(each, sizing_mode="stretch_width", margin=0) for each in figures]
        rows = [pn.Row(*panes[start : start + 2], sizing_mode="stretch_width", margin=0) for start in (0, 2)]
        self.layout = pn.Column(*rows, sizing_mode="stretch_width", margin=0)

    def _loss(self) -> figure:
        """Critic loss as the optimiser sees it (of scaled rewards in the fast profile)."""
        fig = figure(
            title="critic loss", height=HEIGHT, sizing_mode="stretch_width", x_axis_label="epoch", active_drag=None,
            tools="xpan,xwheel_zoom,box_zoom,reset,save", x_range=self._curves.success.x_range,
        )  # fmt: skip
        fig.toolbar.logo, fig.toolbar.autohide, fig.outline_line_color = None, True, None
        add_lines(fig, self._curves.training, "epoch", [("critic_loss", "critic loss", POLICY_B)])
        add_csv(fig, "learning-critic", self._curves.training)
        return fig

    def show(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Draw these metrics rows (all of a run's, oldest first)."""
        self._curves.update(rows)
