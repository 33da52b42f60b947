"""Lines of an ACMI 2.x text taken apart: continuations joined, values unescaped, nothing judged."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from workbench.acmi.transform import METRES_PER_DEGREE

Place = tuple[float, float, float, float, float]
"""Longitude and latitude as metres east and north, then U and V [m], then altitude [m]."""

_COMMA = re.compile(r"(?<!\\),")
_FIELDS = {3: (0, 1, 2), 5: (0, 1, 2, 6, 7), 6: (0, 1, 2, 3, 4, 5), 9: tuple(range(9))}
"""How many fields `T=` may have, and which of the nine they are."""


def logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """(number of its first line, line) without empty lines and comments; a backslash at the end continues a line."""
    started, held = 0, ""
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), start=1):
        started = started or number
        if line.endswith("\\"):
            held += line[:-1] + "\n"
            continue
        whole, first = held + line, started
        started, held = 0, ""
        if whole and not whole.startswith("//"):
            yield first, whole


def properties(line: str) -> tuple[str, dict[str, str]]:
    """Object id and properties of a line `id,Name=value,...`; a part without `=` is a property without a value."""
    ident, *parts = _COMMA.split(line)
    pairs = (part.partition("=") for part in parts)
    return ident, {name: value.replace("\\,", ",") for name, _equals, value in pairs}


def transform_fields(value: str) -> dict[int, float]:
    """The fields of `T=` that are given, by their place among the nine (0 longitude ... 8 heading).

    Raises:
        ValueError: there are not 3, 5, 6 or 9 fields, or one is not a number.
    """
    texts = value.split("|")
    if len(texts) not in _FIELDS:
        raise ValueError(f"has {len(texts)} fields, legal are 3, 5, 6 and 9")
    return {field: float(text) for field, text in zip(_FIELDS[len(texts)], texts, strict=True) if text}


def places(text: str) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Times `[N]` [s] and `Place`s `[N, 5]` of every object; an empty field keeps its value, one never given is NaN."""
    time_s, last = 0.0, dict[str, dict[int, float]]()
    found: dict[str, list[tuple[float, Place]]] = {}
    for _number, line in logical_lines(text):
        if line.startswith("#"):
            time_s = float(line[1:])
        elif not line.startswith(("-", "0,", "File")):
            ident, given = properties(line)
            if "T" in given:
                known = last.setdefault(ident, {})
                known |= transform_fields(given["T"])
                found.setdefault(ident, []).append((time_s, _place(known)))
    return {
        ident: (np.array([when for when, _ in rows]), np.array([place for _, place in rows]))
        for ident, rows in found.items()
    }


def _place(fields: dict[int, float]) -> Place:
    east, north, altitude, u, v = (fields.get(field, np.nan) for field in (0, 1, 2, 6, 7))
    return east * METRES_PER_DEGREE, north * METRES_PER_DEGREE, u, v, altitude
