"""Files of a result set to download: picture, numbers, curves, the set itself."""

from __future__ import annotations

from typing import Literal

from workbench.reproduce.number_csv import csv_text, curves_csv_text
from workbench.reproduce.result_file import to_text
from workbench.reproduce.result_set import ResultSet

File = tuple[str, str, bytes]
"""Name, media type, content."""


def file_of(result: ResultSet, kind: str) -> File | None:
    """A file of this kind (`png`, `svg`, `csv`, `curves`, `json`); None for one that there is not."""
    if kind == "csv":
        return f"{result.item}.csv", "text/csv", csv_text(result).encode()
    if kind == "curves" and result.curves:
        return f"{result.item}-curves.csv", "text/csv", curves_csv_text(result).encode()
    if kind == "json":
        return f"{result.item}.json", "application/json", to_text(result).encode()
    return _picture(result, kind) if kind in ("png", "svg") else None


def _picture(result: ResultSet, kind: Literal["png", "svg"]) -> File | None:
    # Matplotlib takes half a second to load, which the page would wait for and most visitors need not.
    from workbench.reproduce.pictures import picture_of

    content = picture_of(result, kind)
    media = {"png": "image/png", "svg": "image/svg+xml"}[kind]
    return None if content is None else (f"{result.item}.{kind}", media, content)
