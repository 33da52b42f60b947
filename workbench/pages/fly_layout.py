"""Where the parts of the Fly page go, on wide and narrow screens."""

from __future__ import annotations

from collections.abc import Sequence

import panel as pn

from workbench.pages.wrapping import wrapping

OVER = {"position": "absolute", "top": "0", "left": "0", "right": "0", "zIndex": "1", "pointer-events": "none"}
STAGE_CSS = """
:host { display: grid !important; grid-template-columns: minmax(0, 1fr) 290px; gap: 14px;
  grid-auto-rows: auto; height: auto !important }
@media (max-width: 1180px) { :host { grid-template-columns: minmax(0, 1fr); gap: 8px } }
"""


def arrange(
    controls: Sequence[pn.viewable.Viewable],
    notices: Sequence[pn.viewable.Viewable],
    cards: Sequence[pn.viewable.Viewable],
    replay: pn.viewable.Viewable,
    readouts: pn.viewable.Viewable,
    clock: Sequence[pn.viewable.Viewable],
    events: pn.viewable.Viewable,
    stick: pn.viewable.Viewable,
    tabs: pn.viewable.Viewable,
) -> pn.viewable.Viewable:
    """The page: controls, then replay and events (beside it, or below on narrow screens), then the curves."""
    readouts.styles = OVER
    picture = pn.Column(replay, readouts, sizing_mode="stretch_width", margin=0, styles={"position": "relative"})
    time = wrapping(*clock, gap="12px", align="center", wrap="nowrap")
    both_cards = wrapping(*cards, gap="12px", wrap="nowrap")
    stage = pn.Column(both_cards, picture, time, sizing_mode="stretch_width", margin=0, styles={"gap": "8px"})
    return pn.Column(
        wrapping(*controls, gap="14px", align="end"),
        *notices,
        pn.Row(stage, events, sizing_mode="stretch_width", margin=0, stylesheets=[STAGE_CSS]),
        stick,
        tabs,
        sizing_mode="stretch_width",
        margin=(10, 18),
        styles={"gap": "8px"},
    )
