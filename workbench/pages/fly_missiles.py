"""Chips, one per missile: lit when it flies, struck out when it is masked."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent


class MissileChips(JSComponent):
    """A mask as chips to click."""

    masked = param.List(default=[], item_type=int, doc="masked missiles, ascending, from 1")
    colours = param.List(default=[], item_type=str, doc="#rrggbb per missile; their number is that of the missiles")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
