"""Where the parts below the table of the Runs page stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui

from workbench.pages.wrapping import wrapping


def beside(left: Sequence[Any], right: Any) -> pn.viewable.Viewable:
    """Curves and difference over each other, and beside them, or below where it is narrow, the panel of the run."""
    wide = pmui.Column(*left, margin=0, sx={"gap": "12px"}, styles={"flex": "3 1 560px", "min-width": "0"})
    narrow = pmui.Column(right, margin=0, styles={"flex": "2 1 340px", "min-width": "0"})
    return wrapping(wide, narrow, gap="12px")


def difference_title(every_field: Any) -> pmui.Row:
    """The heading of the difference, with the box that shows every field."""
    heading = pn.pane.HTML("<b>Difference of configurations</b>", margin=0, sizing_mode=None)
    return pmui.Row(heading, every_field, margin=0, sx={"alignItems": "center", "gap": "14px"})


def panel(*parts: Any) -> pmui.Paper:
    """Parts on a sheet of their own."""
    return pmui.Paper(*parts, elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px", "gap": "10px"})
