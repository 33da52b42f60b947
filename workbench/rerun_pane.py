"""Rerun's web viewer as a Panel component: opens recordings of this server and shares the page's clock."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent

from layouts.recording_clock import CLOCK


class RerunPane(JSComponent):
    """Loads the viewer once; a new `recording` goes into it without loading it again."""

    viewer = param.String(default="/rerun/index.html", doc="address of the viewer, on this server")
    recording = param.String(default="", doc="address of an .rrd, on this server; fetched with the session's cookie")
    timeline = param.String(default=CLOCK)
    start = param.Number(default=0.0, doc="where the page's clock is when the pane is made [s]")
    theme = param.String(default="dark", doc="dark or light")
    ready = param.Boolean(default=False, doc="the viewer has started; set by the browser")
    error = param.String(default="", doc="one sentence when something failed; set by the browser")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
