"""Where the lattice draws each task: all of them with names while they are few, else the chain above blocks of dots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

Mask = frozenset[int]
Place = tuple[float, float]

ROOMY_UP_TO = 4
"""Missiles up to which every task has room for its name: 16 tasks."""
NODE_SIZE = 46
"""Diameter of a task with a name [px]."""
CHAIN_Y = 0.45
BLOCK_Y = -0.16
"""Height of the chain, and of the middle of the blocks below it, when there is no room for names."""
COLUMNS = 4
GAP_X = 0.21
ASPECT = 2.1
"""Width over height of a figure of its usual size, in units of the vertical axis: dots are as far apart both ways."""


def masks_by_level(missiles: int) -> list[list[Mask]]:
    """All 2^n masks; entry k holds those that leave k missiles, in the order of the numbers that are left."""
    every = range(1, missiles + 1)
    return [
        [frozenset(every) - frozenset(kept) for kept in combinations(every, count)] for count in range(missiles + 1)
    ]


def nested_chain(missiles: int) -> list[Mask]:
    """Algorithm 3's chain of Table 1, from the easiest task (all masked) to the target (none masked)."""
    return [frozenset(range(count + 1, missiles + 1)) for count in range(missiles + 1)]


@dataclass(frozen=True)
class Plan:
    """Places of all tasks (x: missiles left, y: -0.62 to 0.62) and diameters [px] by mask."""

    roomy: bool
    places: dict[Mask, Place]
    sizes: dict[Mask, float]


def plan(missiles: int, chain: Sequence[Mask]) -> Plan:
    """How to draw the 2^n tasks of n missiles."""
    levels = masks_by_level(missiles)
    if missiles <= ROOMY_UP_TO:
        places = {mask: place for level, masks in enumerate(levels) for mask, place in _column(level, masks)}
        return Plan(True, places, dict.fromkeys(places, float(NODE_SIZE)))
    places, sizes = {}, {}
    dot = 14.0 if missiles <= 6 else 11.5
    for level, masks in enumerate(levels):
        others = [mask for mask in masks if mask not in chain]
        named = [mask for mask in masks if mask in chain]
        places |= {mask: (float(level), CHAIN_Y) for mask in named} | dict(_block(level, others, missiles))
        sizes |= dict.fromkeys(named, float(NODE_SIZE)) | dict.fromkeys(others, dot)
    return Plan(False, places, sizes)


def _column(level: int, masks: Sequence[Mask]) -> Iterator[tuple[Mask, Place]]:
    gap = 1.0 / max(len(masks), ROOMY_UP_TO)
    top = gap * (len(masks) - 1) / 2
    for row, mask in enumerate(masks):
        yield mask, (float(level), top - gap * row)


def _block(level: int, masks: Sequence[Mask], missiles: int) -> Iterator[tuple[Mask, Place]]:
    """Tasks of one level in rows of at most `COLUMNS`."""
    columns = min(COLUMNS, max(1, math.ceil(math.sqrt(len(masks)))))
    rows = math.ceil(len(masks) / columns)
    gap_y = GAP_X * ASPECT / (missiles + 1.2)
    for number, mask in enumerate(masks):
        row, column = divmod(number, columns)
        x = level + GAP_X * (column - (columns - 1) / 2)
        yield mask, (x, BLOCK_Y + gap_y * ((rows - 1) / 2 - row))
