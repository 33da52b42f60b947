"""What is asked of the index: a search as SQL with every value bound, never as text that is run."""

from __future__ import annotations

import types
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

FACETS: Final = ("state", "task", "variant", "profile", "scenario", "tag")
"""What runs are narrowed down by: a run is listed if it has one of the chosen values of each."""

SORTS: Final[Mapping[str, str]] = types.MappingProxyType(
    {
        "started": "CASE started WHEN '' THEN created ELSE started END",
        "state": "state",
        "name": "CASE name WHEN '' THEN NULL ELSE name END COLLATE NOCASE",
        "task": "curriculum DESC, missiles",
        "variant": "variant",
        "profile": "profile",
        "seed": "seed",
        "success": "success",
        "return": "mean_return",
        "steps": "steps",
        "time": "wall_s",
    }
)
"""What runs are ordered by."""
NEWEST_FIRST: Final = "-started"


@dataclass(frozen=True)
class RunSearch:
    """Which runs are wanted, in which order."""

    text: str = ""
    """Words that all occur somewhere in a run; one with a minus before it must not."""
    chosen: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Values by facet; a facet without values narrows nothing."""
    sort: str = NEWEST_FIRST
    """A key of SORTS, with a minus before it for falling."""
    trashed: bool = False
    """The runs in the trash instead of the others."""


def where(search: RunSearch) -> tuple[str, list[Any]]:
    """The condition as SQL with `?` for every value, and the values."""
    parts: list[str] = ["trashed = ?"]
    values: list[Any] = [int(search.trashed)]
    for word in search.text.lower().split():
        absent = word.startswith("-") and len(word) > 1
        parts.append("instr(haystack, ?) = 0" if absent else "instr(haystack, ?) > 0")
        values.append(word[1:] if absent else word)
    for name in FACETS:
        if wanted := search.chosen.get(name, ()):
            parts.append(f"({' OR '.join([_is(name)] * len(wanted))})")
            values.extend(_value(name, value) for value in wanted)
    return " AND ".join(parts), values


def _is(facet: str) -> str:
    return "instr(tags, ?) > 0" if facet == "tag" else f"{facet} = ?"


def _value(facet: str, value: str) -> Any:
    return f"\n{value}\n" if facet == "tag" else value


def order(sort: str) -> str:
    """The order as SQL: runs without the value last, then the newest first; an unknown key sorts as the newest do."""
    falling, key = sort.startswith("-"), sort.removeprefix("-")
    if key not in SORTS:
        falling, key = True, "started"
    direction = "DESC" if falling else "ASC"
    terms = [f"{term.removesuffix(' DESC')} {direction}" for term in SORTS[key].split(", ")]
    return f"{terms[0]} NULLS LAST, {', '.join([*terms[1:], 'id DESC'])}"
