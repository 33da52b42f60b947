"""Where the parts of the Fly page go, on wide and narrow screens."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn
import panel_material_ui as pmui

REPLAY_HEIGHT = 325


def arrange(
    controls: Sequence[pn.viewable.Viewable],
    notices: Sequence[pn.viewable.Viewable],
    cards: Sequence[pn.viewable.Viewable],
    replay: pn.viewable.Viewable,
    clock: pn.viewable.Viewable,
    events: pn.viewable.Viewable,
    tabs: pn.viewable.Viewable,
) -> pn.viewable.Viewable:
    """The page: controls, then replay and events (beside it, or below on narrow screens), then the curves."""
    replay.height = REPLAY_HEIGHT
    stage = pmui.Column(
        pn.FlexBox(*cards, flex_wrap="nowrap", gap="12px", sizing_mode="stretch_width", margin=0),
        replay, clock, margin=0, sizing_mode="stretch_width", styles={"flex": "1 1 720px", "gap": "8px", "min-width": "0"},
    )  # fmt: skip
    side = pmui.Column(
        events, margin=0, styles={"flex": "0 1 290px", "height": f"{REPLAY_HEIGHT + 120}px", "min-width": "260px"}
    )
    return pn.Column(
        pn.FlexBox(*controls, gap="14px", align_items="end", sizing_mode="stretch_width", margin=0),
        *notices,
        pn.FlexBox(stage, side, gap="14px", sizing_mode="stretch_width", margin=0),
        tabs,
        sizing_mode="stretch_width", margin=(10, 18), styles={"gap": "8px"},
    )  # fmt: skip
