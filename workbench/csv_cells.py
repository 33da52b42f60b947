"""Cells of a CSV that a spreadsheet shows and never works out, whatever a name in them looks like."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from workbench.terminal import printable

FORMULA_STARTS: Final = tuple("=+-@＝＋－＠")
"""First characters that make a spreadsheet take a text for a formula, full-width forms included."""


def plain_cell(value: Any) -> Any:
    """The value: of a text one printable line, with an apostrophe before it if it would begin a formula.

    Numbers stay numbers. A carriage return within a cell would end the row for some readers.
    """
    if not isinstance(value, str):
        return value
    line = printable(value)
    return f"'{line}" if line.startswith(FORMULA_STARTS) else line


def plain_row(values: Iterable[Any]) -> list[Any]:
    """A row of such cells."""
    return [plain_cell(value) for value in values]
