"""The table of runs: thousands of lines of which the browser holds those in view."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

COLUMNS: tuple[dict[str, Any], ...] = (
    {"name": "state", "title": "State", "width": 106, "sort": "state"},
    {"name": "name", "title": "Name", "width": 190, "grow": 2, "sort": "name"},
    {"name": "task", "title": "Task", "width": 124, "grow": 1, "sort": "task", "help": "What is learned"},
    {"name": "variant", "title": "Variant", "width": 78, "sort": "variant"},
    {"name": "profile", "title": "Profile", "width": 70, "sort": "profile", "least": 896},
    {"name": "seed", "title": "Seed", "width": 52, "sort": "seed", "right": True},
    {"name": "success", "title": "Success", "width": 130, "sort": "success",
     "help": "Best held-out success rate of the latest stage; behind it, points over the expert on that task"},
    {"name": "return", "title": "Return", "width": 66, "sort": "return", "right": True, "least": 972,
     "help": "Mean return of the best policy"},
    {"name": "steps", "title": "Steps", "width": 72, "sort": "steps", "right": True, "least": 1394,
     "help": "Environment steps of the latest stage"},
    {"name": "time", "title": "Time", "width": 66, "sort": "time", "right": True, "least": 1048, "help": "Time worked"},
    {"name": "started", "title": "Started", "width": 134, "sort": "started", "least": 1192},
    {"name": "tags", "title": "Tags", "width": 110, "grow": 1, "least": 1312},
)  # fmt: skip
"""Columns: what a line calls the value, its title, least width [px] and share of what is left over, its key of
`run_index.query.SORTS`, and from which width of the table on [px] it is shown."""
TABLE_HEIGHT = 380


class RunsTable(JSComponent):
    """A window of lines. Scrolling asks for another one; clicks and keys say what is ticked, opened, read about.

    What is large travels as JSON text: Panel and Bokeh walk through every value of a list or dict at every change.
    """

    columns = param.String(default=json.dumps(COLUMNS))
    lines = param.String(default="[]", doc="the window: dicts as `runs_lines` makes them; every text is shown as text")
    offset = param.Integer(default=0, doc="number of the first line of the window")
    total = param.Integer(default=0, doc="number of all lines")
    pinned = param.String(default="null", doc="the line above all others")
    first = param.Integer(default=0, doc="number of the first line in view; set by the browser")
    sort = param.String(default="", doc="key, with a minus before it for falling; set by the browser")
    focused = param.String(default="", doc="key of the run that is read about; set by the browser")
    asked = param.List(default=["", "", 0], doc="what was asked of which line, and a count; set by the browser")
    inks = param.List(default=[], item_type=str, doc="#rrggbb by the place of a curve")
    empty = param.String(default="", doc="what to say, and do, when there is no line")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
