"""How the curves of the Live page are looked at: axis, smoothing, panels; and one line under the pointer over all."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.learning_curves import HOVER_TAG
from layouts.learning_panels import PANELS, LearningCurve
from layouts.theme import FILLED_CSS
from workbench.pages.live_settings import X_AXES


class LiveView(JSComponent):
    """The bar above the curves. Everything a person changes here is one value that Python hears of."""

    x = param.String(default="steps", doc="a key of axes; set by the browser")
    axes = param.Dict(default=dict(X_AXES))
    smooth = param.Integer(default=0, doc="weight of the past [%]; set by the browser")
    panels = param.List(default=[[panel.key, panel.title, panel.help] for panel in PANELS])
    without = param.List(default=[], item_type=str, doc="keys of panels that are not shown; set by the browser")
    tag = param.String(default=HOVER_TAG, doc="tag of the figures that share the line under the pointer")
    visited = param.List(default=["", 0], doc="the address gone back or forward to, and a count; set by the browser")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [FILLED_CSS + Path(__file__).with_suffix(".css").read_text("utf-8")]


class LiveKey(JSComponent):
    """The title of a panel and its curves with their values: the latest, or those under the pointer.

    Not called a legend: by the end of a class's name panel-material-ui takes it for Bokeh's, and colours it.
    """

    title = param.String(default="")
    help = param.String(default="", doc="what the panel shows, in a sentence")
    curves = param.List(default=[], doc="dicts as `legend_curves` makes them")
    latest = param.Dict(default={}, doc="latest value by name of the curve; None where there is none")
    several = param.Boolean(default=False, doc="curves of several runs are drawn: dashes tell them apart, not inks")
    hidden = param.List(default=[], item_type=str, doc="names of the curves that are taken out")
    asked = param.List(default=["", 0], doc="the curve that was clicked, and a count; set by the browser")

    _esm = Path(__file__).parent / "live_key.js"
    _stylesheets: ClassVar[list[str]] = [(Path(__file__).parent / "live_key.css").read_text("utf-8")]


def legend_curves(curves: tuple[LearningCurve, ...]) -> list[dict[str, Any]]:
    """What `LiveKey` shows of a panel's curves."""
    return [
        {"name": curve.name, "label": curve.label, "ink": curve.ink, "help": curve.help, "digits": curve.digits,
         "share": curve.share}
        for curve in curves
    ]  # fmt: skip
