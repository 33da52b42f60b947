"""Where the parts of the Live page stand: list and events beside the run, or above it where it is narrow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import panel as pn
import panel_material_ui as pmui

from layouts.theme import FILLED_CSS
from workbench.pages.address import search

if TYPE_CHECKING:
    from workbench.pages.live import LivePage

NARROW_PX = 1180
NO_BUTTON = ".scroll-button { display: none }"
"""Panel's button to scroll takes a place, and a gap, in every column, though these never scroll."""
OUTER_CSS = f"""
:host {{ display: flex !important; flex-direction: row !important; align-items: flex-start; gap: 12px }}
@media (max-width: {NARROW_PX}px) {{ :host {{ flex-direction: column !important; align-items: stretch }} }}
"""
SIDE_CSS = f"""
:host {{ flex: 0 0 264px !important; width: 264px !important; min-width: 0 }}
@media (max-width: {NARROW_PX}px) {{
  :host {{ flex: 0 0 auto !important; width: 100% !important; flex-direction: row !important }}
}}
"""
MAIN_CSS = f"""
:host {{ flex: 1 1 0 !important; min-width: 0 }}
@media (max-width: {NARROW_PX}px) {{ :host {{ flex: 0 0 auto !important }} }}
"""
BESIDE_CSS = f"@media (max-width: {NARROW_PX}px) {{ :host {{ flex: 1 1 0 !important; width: 0 !important }} }}"
"""List and events share a row where the page is narrow."""
EMPTY_CSS = (
    FILLED_CSS
    + """
:host { font: 15px/1.5 var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color) }
h1 { font-size: 21px; margin: 6px 0 4px }
p { margin: 0 0 16px; opacity: .86; max-width: 640px }
a { display: inline-block; font-weight: 650; text-decoration: none; border-radius: 7px; padding: 8px 15px;
  margin: 0 8px 8px 0; color: inherit; border: 1px solid color-mix(in srgb, currentColor 38%, transparent) }
a.main { background: var(--filled); border-color: var(--filled); color: #fff }
a:focus-visible { outline: 3px solid #2f86ff; outline-offset: 2px }
"""
)


class LiveLayout:
    """The page's parts in their places, and which of them are there.

    Parts are put in when there is something to show: what is made visible before the browser has built it stays hidden.
    """

    def __init__(self, page: LivePage) -> None:
        page.empty.stylesheets = [EMPTY_CSS]
        self._list, self._alert = panel(page.list, stylesheets=[BESIDE_CSS]), page.alert
        self._empty = panel(page.empty)
        self._run = [panel(page.head, page.chain, css_classes=["tour-live"]), panel(page.view, page.curves.layout)]
        self._events = panel(page.events, stylesheets=[BESIDE_CSS])
        gap: dict[str, Any] = {"sizing_mode": "stretch_width", "margin": 0, "styles": {"gap": "12px"}}
        self._side = pn.Column(self._list, stylesheets=[SIDE_CSS, NO_BUTTON], **gap)
        self._main = pn.Column(self._alert, stylesheets=[MAIN_CSS, NO_BUTTON], **gap)
        self.layout = pn.Column(
            self._side, self._main, stylesheets=[OUTER_CSS, NO_BUTTON], sizing_mode="stretch_width", margin=(12, 18)
        )

    def stand(self, shown: bool, named: bool) -> None:
        """Show the run, or, where none is `named`, what to do."""
        middle = self._run if shown else ([] if named else [self._empty])
        places = ((self._side, [self._list, *([self._events] if shown else [])]), (self._main, [self._alert, *middle]))
        for column, parts in places:
            if list(column.objects) != parts:
                column.objects = parts


def nothing(finished: str) -> str:
    """What to do where nothing is being trained; `finished` is the newest run to look back at, if there is one."""
    again = f'<a href="/live{search({"run": finished})}">Look back at the newest run</a>' if finished else ""
    words = "Every run that has ended is in the list, with its curves as they were." if finished else (
        "A run of the smoke profile takes seconds, one of the fast profile some minutes a stage; both go on when the "
        "browser is closed."
    )  # fmt: skip
    return (
        "<h1>Nothing is being trained</h1><p>Choose a task and a variant on the Curriculum page "
        f'and launch it; it is then shown here as it learns. {words}</p><a class="main" href="/curriculum">Launch a '
        f"training</a>{again}"
    )


def panel(*parts: Any, **more: Any) -> pmui.Paper:
    """Parts on a sheet of their own."""
    sheet = {"p": "12px 16px", "gap": "10px"}
    return pmui.Paper(*parts, elevation=1, margin=0, sizing_mode="stretch_width", sx=sheet, **more)
