"""What the Paper page writes: tables, points, commands and notes, in which every number can be asked where it is from.

A block is a dict with its `kind`; a cell of a table is a list of parts. The browser sets all of it as text.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

Part = dict[str, Any]
"""`t` (text) and perhaps `sub`, `refs` (records it stands for), `href`, `section`, `tone`, `ink`, `title`, `strike`."""
Block = dict[str, Any]
"""`kind` (table, points, heading, text, notes, command, downloads, tiles) and what that kind needs."""


class PaperSheet(JSComponent):
    """Blocks, one below the other; `chosen` records are shown below the first table."""

    blocks = param.List(default=[], item_type=dict)
    records = param.Dict(default={}, doc="by key: title, facts, links and commands")
    chosen = param.List(default=[], item_type=str, doc="keys of the records that are shown")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]

    def __init__(self, heard: Callable[[Mapping[str, str]], None] = lambda message: None, **params: Any) -> None:
        """`heard` gets what a person asks for: `download` with a kind, or `section` with a name."""
        self._heard = heard
        super().__init__(**params)

    def _handle_msg(self, data: Any) -> None:
        if isinstance(data, dict):
            self._heard({str(name): str(value) for name, value in data.items()})

    def hand_over(self, name: str, kind: str, content: bytes) -> None:
        """Have the browser save a file."""
        self._send_msg({"file": {"name": name, "type": kind, "base64": base64.b64encode(content).decode()}})

    def saved_nothing(self) -> None:
        """Let the person ask again."""
        self._send_msg({"file": None})


def part(text: str, **more: Any) -> Part:
    """A piece of a cell."""
    return {"t": text, **{name: value for name, value in more.items() if value}}


def table(columns: Iterable[str | tuple[str, str]], rows: Sequence[Sequence[Sequence[Part]]]) -> Block:
    """A table; a column is a title, or a title and what stands below it."""
    heads = [part(one) if isinstance(one, str) else part(one[0], sub=one[1]) for one in columns]
    return {"kind": "table", "columns": heads, "rows": [[list(cell) for cell in row] for row in rows]}


def heading(text: str, sub: str = "") -> Block:
    """A title inside a sheet."""
    return {"kind": "heading", "t": text, "sub": sub}


def words(text: str, tone: str = "") -> Block:
    """A paragraph."""
    return {"kind": "text", "t": text, "tone": tone}


def notes(sentences: Sequence[str]) -> Block:
    """A list of sentences."""
    return {"kind": "notes", "notes": list(sentences)}


def command(text: str, label: str = "") -> Block:
    """A command line with a button that copies it."""
    return {"kind": "command", "t": text, "label": label}
