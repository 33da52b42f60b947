"""Four chips, one per missile: lit when it flies, struck out when it is masked."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent


class MissileChips(JSComponent):
    """A mask as chips to click."""

    masked = param.List(default=[], item_type=int, doc="masked missiles, ascending, from 1")
    colours = param.List(default=[], item_type=str, doc="#rrggbb per missile; their number is that of the missiles")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        """
.box { display: flex; flex-direction: column; gap: 4px; font: 12px var(--bokeh-base-font, sans-serif);
  color: var(--panel-on-background-color) }
.label { opacity: .72; padding-left: 2px; white-space: nowrap }
.chips { display: flex; gap: 6px }
button { font: 600 14px var(--bokeh-base-font, sans-serif); height: 34px; min-width: 46px; border-radius: 17px; cursor: pointer;
  border: 2px solid var(--ink); background: var(--ink); color: #fff; transition: all .15s }
button.masked { background: none; color: color-mix(in srgb, var(--panel-on-background-color) 60%, transparent);
  border-style: dashed; text-decoration: line-through; opacity: .75 }
button:hover { filter: brightness(1.15) }
button:focus-visible { outline: 2px solid var(--panel-primary-color); outline-offset: 2px }
"""
    ]
