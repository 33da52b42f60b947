"""Rerun's web viewer as a Panel component: opens recordings of this server and shares the page's clock."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.blueprint import CLOCK


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
    _stylesheets: ClassVar[list[Any]] = [
        """
.pane { position: relative; width: 100%; height: 100%; border-radius: 8px; overflow: hidden }
iframe { width: 100%; height: 100%; border: 0; display: block }
.cover { position: absolute; inset: 0; display: grid; place-items: center; font: 14px var(--bokeh-base-font, sans-serif);
  color: var(--panel-on-background-color); background: var(--panel-background-color); transition: opacity .5s }
.cover.gone { opacity: 0; pointer-events: none }
"""
    ]
