"""The page's clock over the figures: a line over curves, dots on curves and tracks; no figure is redrawn for it."""

from __future__ import annotations

from pathlib import Path

import param
from panel.custom import JSComponent

from layouts.chart import CURSOR_TAG


class FlightCursors(JSComponent):
    """Takes no room; finds the figures by their tag. A redraw of two figures costs 50 ms, moving a line none."""

    tag = param.String(default=CURSOR_TAG, doc="tag of the figures over time")

    _esm = Path(__file__).with_suffix(".js")
