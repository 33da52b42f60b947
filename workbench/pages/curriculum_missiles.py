"""The subtasks as pictures: one missile each, to be masked and unmasked with a click."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent


class MissilePictures(JSComponent):
    """A mask as large pictures of missiles."""

    masked = param.List(default=[], item_type=int, doc="masked missiles, ascending, from 1")
    colours = param.List(default=[], item_type=str, doc="#rrggbb per missile; their number is that of the missiles")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        """
.row { display: flex; gap: clamp(6px, 1.6%, 12px); height: 100% }
.tile { flex: 1 1 0; min-width: 44px; display: flex; flex-direction: column; align-items: center; gap: 6px;
  padding: 12px 4px 8px; border-radius: 14px; cursor: pointer; transition: background .15s, border-color .15s;
  border: 2px solid var(--ink); background: color-mix(in srgb, var(--ink) 14%, transparent);
  font: 600 13px var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color) }
.tile svg { flex: 1 1 auto; min-height: 0; width: 100% }
.tile:hover { background: color-mix(in srgb, var(--ink) 26%, transparent) }
.tile:focus-visible { outline: 3px solid var(--panel-primary-color); outline-offset: 2px }
.body { fill: var(--ink) }
.fins { fill: color-mix(in srgb, var(--ink) 62%, #000) }
.flame { fill: #ffb02e }
.band { stroke: rgb(255 255 255 / .75); stroke-width: 3; fill: none }
text { fill: #fff; font: 800 21px var(--bokeh-base-font, sans-serif) }
.masked { border: 2px dashed color-mix(in srgb, var(--panel-on-background-color) 35%, transparent); background: none;
  font-weight: 400 }
.masked:hover { background: color-mix(in srgb, var(--panel-on-background-color) 7%, transparent) }
.masked .body, .masked .fins { fill: none; stroke: currentColor; stroke-width: 1.6; stroke-dasharray: 4 3;
  opacity: .55 }
.masked .flame, .masked .band { display: none }
.masked text { fill: currentColor; opacity: .55 }
.masked span { opacity: .65; text-decoration: line-through }
"""
    ]
