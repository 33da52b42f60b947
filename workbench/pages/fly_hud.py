"""Read-outs over the 3-D replay: what each evader does, and range, closure, azimuth and energy of all it flees from."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent


class FlightHud(JSComponent):
    """One small table per flight; it follows the page's clock in the browser."""

    flights = param.String(
        default="[]", doc="JSON: a list of what `layouts.instruments.instrument_series` makes, one per flight"
    )
    visible_hud = param.Boolean(default=True, doc="whether the read-outs are shown")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
