"""Cells of a CSV that a spreadsheet shows and never works out, whatever a name in them looks like."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

FORMULA_STARTS: Final = tuple("=+-@\t\r\n＝＋－＠")
"""First characters that make a spreadsheet take a text for a formula, full-width forms included."""


def plain_cell(value: Any) -> Any:
    """The value, a text that would begin a formula with an apostrophe before it; numbers stay numbers."""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA_STARTS) else value


def plain_row(values: Iterable[Any]) -> list[Any]:
    """A row of such cells."""
    return [plain_cell(value) for value in values]
