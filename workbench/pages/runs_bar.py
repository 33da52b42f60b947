"""The bar above the table of runs: search, facets, groups, the trash, and what can be done with what is ticked."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from workbench.pages.runs_settings import GROUPS
from workbench.run_index.query import FACETS

TITLES = {
    "state": "State", "task": "Task", "variant": "Variant", "profile": "Profile", "scenario": "Scenario", "tag": "Tags",
}  # fmt: skip


class RunsBar(JSComponent):
    """What narrows the list down. Everything a person changes here is one value that Python hears of."""

    text = param.String(default="", doc="words to search for; set by the browser while one types")
    facets = param.String(default="[]", doc="JSON: dicts of name, title and options (pairs of value and count)")
    chosen = param.Dict(default={}, doc="lists of values by facet; set by the browser")
    group = param.String(default="", doc="a key of GROUPS; set by the browser")
    groups = param.Dict(default=dict(GROUPS))
    trash = param.Boolean(default=False, doc="show the trash; set by the browser")
    counted = param.String(default="", doc="how many runs were found, in words")
    ticked = param.Integer(default=0, doc="how many runs are shown by themselves")
    asked = param.List(default=["", 0], doc="what a button asked for, and a count; set by the browser")
    visited = param.List(default=["", 0], doc="the address gone back or forward to, and a count; set by the browser")

    _debounce: ClassVar[int] = 0
    """Panel gathers changes for 50 ms before it tells of them: as long as a search takes."""
    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


def facet_options(counts: dict[str, dict[str, int]], chosen: Any) -> list[dict[str, Any]]:
    """What each facet offers, the most frequent value first; chosen values are offered even when no run has them."""
    options = []
    for name in FACETS:
        found = dict.fromkeys(chosen.get(name, ()), 0) | counts.get(name, {})
        ordered = sorted(found.items(), key=lambda pair: (-pair[1], pair[0]))
        options.append({"name": name, "title": TITLES[name], "options": [list(pair) for pair in ordered]})
    return options
