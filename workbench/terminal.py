"""Results on standard output: tables for people, one JSON object for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from workbench.run_files import strict

PIPE_WIDTH = 200
"""Columns of a table that goes to a file or a pipe: wide enough that nothing is cut."""


def print_json(value: Mapping[str, Any]) -> None:
    """One JSON object on standard output; numbers that are not finite become null.

    Control and direction characters are JSON escapes, so that a name cannot steer a terminal here either.
    """
    text = json.dumps(strict(value), indent=2, ensure_ascii=False, allow_nan=False)
    print(text if _harmless(text) else "".join(c if _harmless(c) else json.dumps(c)[1:-1] for c in text))


def _harmless(text: str) -> bool:
    return text.replace("\n", "").isprintable()


def print_line(text: str, *, error: bool = False) -> None:
    """One line on standard output or standard error; names in it are data, as everywhere."""
    print(printable(text), file=sys.stderr if error else sys.stdout)


def print_table(columns: Sequence[str], rows: Sequence[Sequence[str]], title: str = "") -> None:
    """A table on standard output; cells are data: markup and control sequences in them have no effect."""
    if title:
        print(printable(title), end="\n\n")
    table = Table(box=None, pad_edge=False, header_style="bold")
    for column in columns:
        table.add_column(Text(printable(column)), overflow="fold")
    for row in rows:
        table.add_row(*(Text(printable(cell)) for cell in row))
    width = None if sys.stdout.isatty() else PIPE_WIDTH
    Console(file=sys.stdout, highlight=False, width=width).print(table)


def print_warning(sentence: str) -> None:
    """One line on standard error: something a person should know though nothing failed."""
    print_line(f"workbench: warning: {sentence}", error=True)


def printable(text: str) -> str:
    """The text with control and direction characters as escapes: a name cannot steer a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def percent(share: float | None) -> str:
    """A share 0..1 as a percentage, or a dash."""
    return "–" if share is None else f"{100 * share:.1f} %"


def duration(seconds: float | None) -> str:
    """Seconds as h:mm:ss or m:ss, or a dash."""
    if seconds is None:
        return "–"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
