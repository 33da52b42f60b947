"""The list of tables and figures beside the Paper page: where one is, and how each stands."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent


class PaperContents(JSComponent):
    """Entries to choose a section by; the browser's back and forward choose one too."""

    items = param.List(default=[], item_type=dict, doc="name, title, sub, hint and state (code, done, part, none)")
    section = param.String(default="", doc="name of the section that is shown")
    address = param.String(default="", doc="query that the browser went back or forth to")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        """
:host { color: var(--panel-on-background-color); font: 14px/1.3 var(--bokeh-base-font, sans-serif) }
nav { display: flex; flex-direction: column; gap: 2px }
button { font: inherit; color: inherit; text-align: left; background: none; border: 0; border-radius: 8px;
  padding: 6px 10px; cursor: pointer; display: grid; grid-template-columns: 14px 1fr; column-gap: 8px;
  align-items: center }
button:hover { background: color-mix(in srgb, currentColor 8%, transparent) }
button[aria-current] { background: color-mix(in srgb, var(--panel-primary-color) 24%, transparent) }
button:focus-visible { outline: 2px solid var(--panel-primary-color) }
.dot { width: 10px; height: 10px; border-radius: 50%; border: 2px solid var(--ink, #7d8794); box-sizing: border-box }
[data-state=done] .dot, [data-state=code] .dot { --ink: #1fa05f; background: var(--ink) }
[data-state=part] .dot { --ink: #e08a00; background: linear-gradient(90deg, var(--ink) 50%, transparent 0) }
.title { font-weight: 650 }
.sub { grid-column: 2; opacity: .7; font-size: 12.5px }
.sub:empty { display: none }
"""
    ]
