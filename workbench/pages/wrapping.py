"""Parts side by side, in as many lines as they need.

Panel has a `FlexBox` for this, but it is a template that every page compiles anew and that the browser keeps for ever
(14 KB per opening of a page); a row with other style sheets is what Bokeh draws anyway.
"""

from __future__ import annotations

from typing import Any

import panel as pn

LINES_CSS = """
:host {{ flex-wrap: {wrap}; gap: {gap}; align-items: {align}; align-content: flex-start }}
:host > * {{ flex: 0 1 auto; align-self: auto; min-width: auto }}
"""


class Lines(pn.Row):
    """A row that is as wide as its widest part at least; Panel's own is as wide as all of them together."""

    _direction = None


def wrapping(*parts: Any, gap: str, align: str = "flex-start", wrap: str = "wrap", **look: Any) -> Lines:
    """A row over the whole width whose parts go on in another line where it is too narrow.

    Args:
        parts: what stands in it; a part may say how it grows and shrinks, as in `styles={"flex": "1 1 340px"}`.
        gap: space between parts and between lines [CSS length].
        align: how the parts of a line stand to each other [CSS align-items].
        wrap: "nowrap" keeps all in one line [CSS flex-wrap].
        look: further parameters of the row.
    """
    css = LINES_CSS.format(wrap=wrap, gap=gap, align=align)
    return Lines(*parts, sizing_mode="stretch_width", margin=0, stylesheets=[css], **look)
