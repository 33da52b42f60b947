"""A whole number with its name on the frame: typed, stepped by − and +, or by the arrow keys.

Panel Material UI has such a field too, but its − and + have no names for people who cannot see them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent


class NumberField(JSComponent):
    """A whole number between two bounds; what is typed beyond them becomes the nearest bound."""

    value = param.Integer(default=0, doc="the number, once it is entered")
    start = param.Integer(default=0, doc="least value")
    end = param.Integer(default=100, doc="greatest value, at most 2^53 - 1, the largest that a browser counts exactly")
    label = param.String(default="", doc="name, on the frame")
    words = param.String(default="", doc="help that shows under the pointer; empty: none")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [Path(__file__).with_suffix(".css")]
