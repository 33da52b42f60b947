"""The replay as one HTML file that opens from a disk: engagements, script and style inside, and nothing fetched.

viser can write such a file too (`as_html`), but its clock cannot be asked or set, so curves could not follow it.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Sequence
from pathlib import Path
from string import Template

from sim.trajectory import Trajectory
from workbench.export_replay import replay_record, title_of

HERE = Path(__file__).parent
SCRIPTS = ("view", "scene", "curves", "", "controls")
"""Parts of the script in the order in which they are read: `replay_page_view.js` …"""


def replay_page(flights: Sequence[Trajectory]) -> bytes:
    """The file: one or two flights from the same initial state, to be opened in any browser."""
    parts = [_read(f"replay_page{'_' if part else ''}{part}.js") for part in SCRIPTS]
    script = _PROLOGUE + "\n".join(parts) + _EPILOGUE
    style = _read("replay_page.css")
    title = title_of(flights)
    page = Template(_read("replay_page.html")).substitute(
        policy=content_policy(script, style),
        generator="SubMas workbench",
        title=html.escape(title),
        description=html.escape(f"Replay of an engagement: {title}"),
        style=style,
        data=embedded(replay_record(flights)),
        script=script,
    )
    return page.encode()


def content_policy(script: str, style: str) -> str:
    """Only this script and this style run; every request is refused, whatever asks for it."""
    allowed = f"script-src '{_digest(script)}'; style-src '{_digest(style)}'; img-src data:"
    return f"default-src 'none'; {allowed}; base-uri 'none'; form-action 'none'"


def embedded(record: object) -> str:
    """A record as JSON that can stand inside a script element: no name in it can end that element."""
    text = json.dumps(record, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _read(name: str) -> str:
    return (HERE / name).read_text("utf-8")


_PROLOGUE = """"use strict";
{
const data = JSON.parse(document.getElementById("flight-data").textContent)
const show = {labels: true, trails: true, beams: true}
"""
_EPILOGUE = "}\n"
