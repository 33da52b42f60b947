"""The moment from which on somebody else would fly: the clock's, told by the browser itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent


class StickMoment(JSComponent):
    """`from 4:31 on`, moving with the page's clock."""

    over = param.Boolean(default=False, doc="whether the flight is over by then")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        "span { font: 14px var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color);"
        " white-space: nowrap }"
    ]
