"""The links to the pages, in the frame of each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import panel as pn

from layouts.theme import FILLED_CSS

CSS = FILLED_CSS + Path(__file__).with_suffix(".css").read_text()


class Navigation:
    """A row of links. One pane of markup: a Material button for each would cost every page a tenth of a second."""

    def __init__(self, pages: Mapping[str, str], current: str, *, dark: bool) -> None:
        """Make the links.

        Args:
            pages: address and name of each.
            current: address of the one that is open.
            dark: whether it is shown in dark colours.
        """
        self._pages, self._current = pages, current
        self.pane = pn.pane.HTML(self._links(dark), stylesheets=[CSS], margin=0, sizing_mode=None)

    def keep_theme(self, dark: bool) -> None:
        """The other pages come up in the colours of this one."""
        self.pane.object = self._links(dark)

    def _links(self, dark: bool) -> str:
        suffix = "" if dark else "?theme=default"
        here = {self._current: ' aria-current="page"'}
        links = [f'<a href="/{name}{suffix}"{here.get(name, "")}>{title}</a>' for name, title in self._pages.items()]
        return f'<nav aria-label="Pages">{"".join(links)}</nav>'
