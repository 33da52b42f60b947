"""The curves of the Live page: small multiples with one axis, one line under the pointer, and their latest values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.chart import Columns
from layouts.learning_curves import LearningCurves, RunLearning
from layouts.learning_panels import PANELS
from workbench.pages.live_settings import LiveSettings
from workbench.pages.live_view import LiveKey, legend_curves
from workbench.pages.runs_metrics import X_LABELS

HEIGHT = 172
GRID = {
    "display": "grid",
    "grid-template-columns": "repeat(auto-fill, minmax(min(max(330px, 24%), 100%), 1fr))",
    "gap": "12px 14px",
}


@dataclass(frozen=True)
class LiveDrawing:
    """Everything the figures show."""

    runs: tuple[RunLearning, ...]
    stages: Columns
    """Where the stages of the first run begin."""
    latest: Mapping[str, float | None]
    """Its latest values by name."""


class LiveCurves:
    """One figure and one legend per panel; `on_hide` hears which curve was clicked."""

    def __init__(self, on_hide: Callable[[str], None]) -> None:
        self._curves = LearningCurves(HEIGHT)
        self._legends = {
            panel.key: LiveKey(
                title=panel.title, help=panel.help, curves=legend_curves(panel.curves), margin=0,
                sizing_mode="stretch_width",
            )
            for panel in PANELS
        }  # fmt: skip
        for legend in self._legends.values():
            legend.param.watch(lambda event: on_hide(event.new[0]), "asked")
        self._panels = {panel.key: self._panel(panel.key) for panel in PANELS}
        self.layout = pn.Column(*self._panels.values(), sizing_mode="stretch_width", margin=0, styles=GRID)

    def _panel(self, key: str) -> pmui.Column:
        pane = pn.pane.Bokeh(self._curves.figures[key], sizing_mode="stretch_width", margin=0)
        return pmui.Column(
            self._legends[key], pane, margin=0, sizing_mode="stretch_width", sx={"gap": "0px", "minWidth": 0}
        )

    def take(self, settings: LiveSettings) -> None:
        """Show these panels and curves."""
        for key, panel in self._panels.items():
            panel.visible = key not in settings.without
        for legend in self._legends.values():
            legend.hidden = [curve["name"] for curve in legend.curves if curve["name"] in settings.hidden]
        self._curves.hide(settings.hidden)

    def show(self, settings: LiveSettings, drawing: LiveDrawing) -> None:
        """Draw this."""
        self._curves.show(drawing.runs, drawing.stages, X_LABELS[settings.x], settings.smooth > 0)
        for legend in self._legends.values():
            names = [curve["name"] for curve in legend.curves]
            legend.param.update(
                latest={name: drawing.latest.get(name) for name in names}, several=len(drawing.runs) > 1
            )


def latest_values(columns: Mapping[str, Sequence[float]]) -> dict[str, float | None]:
    """The latest measured value of every curve; None where there is none."""
    found: dict[str, Any] = {}
    for panel in PANELS:
        for curve in panel.curves:
            known = (value for value in reversed(columns[curve.name]) if math.isfinite(value))
            found[curve.name] = next(known, None)
    return found
