"""Arrays by name, and those of several parts together: how everything that learns is laid down and taken up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]
"""Names may hold slashes: `part/array`."""


def joined(parts: Mapping[str, Mapping[str, NDArray[Any]]]) -> Arrays:
    """The arrays of several parts under names `part/array`."""
    return {f"{part}/{name}": array for part, arrays in parts.items() for name, array in arrays.items()}


def below(part: str, arrays: Mapping[str, NDArray[Any]]) -> Arrays:
    """The arrays of one part, by their names within it."""
    return {name.removeprefix(f"{part}/"): array for name, array in arrays.items() if name.startswith(f"{part}/")}
