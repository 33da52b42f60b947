"""Where the lattice draws each task: wide nodes while they are few, else Table 1's chain above blocks of small ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

Mask = frozenset[int]
Place = tuple[float, float]
Size = tuple[float, float]

ROOMY_UP_TO = 4
"""Missiles up to which every task is a wide node with all its links: 16 tasks."""
NAMED_UP_TO = 6
"""Missiles up to which every task has its name written on it: 64 tasks."""
WIDE: Size = (0.78, 30.0)
"""Width [levels] and height [px] of wide nodes; links end where they do."""
CHIP_PITCH = 19.0
"""Distance of the missiles drawn on a wide node [px]."""
CHAIN: Size = (46.0, 26.0)
"""Width and height of nodes [px]."""
CHAIN_Y, BLOCK_Y = 0.5, -0.1
"""Height of the chain, and of the middle of the blocks below it, where nodes are not wide."""
PLOT: Size = (580.0, 1.0 / 1.24 * 372.0)
"""Width of all levels, and height of one unit, of the smallest figure in which nothing may touch [px]."""


@dataclass(frozen=True)
class Style:
    """Small nodes of a block: size and distance of their centres [px], and how many stand side by side."""

    size: Size
    pitch: Size
    columns: int


@dataclass(frozen=True)
class Plan:
    """Places of all tasks (x: missiles left, y: -0.62 to 0.62) and their sizes by mask.

    Sizes are pixels; the width of wide nodes, where there is room for them, is one of x.
    """

    roomy: bool
    named: bool
    places: dict[Mask, Place]
    sizes: dict[Mask, Size]


def masks_by_level(missiles: int) -> list[list[Mask]]:
    """All 2^n masks; entry k holds those that leave k missiles, in the order of the numbers that are left."""
    every = range(1, missiles + 1)
    return [
        [frozenset(every) - frozenset(kept) for kept in combinations(every, count)] for count in range(missiles + 1)
    ]


def nested_chain(missiles: int) -> list[Mask]:
    """Algorithm 3's chain of Table 1, from the easiest task (all masked) to the target (none masked)."""
    return chain_of(missiles, range(1, missiles + 1))


def chain_of(missiles: int, met: Sequence[int]) -> list[Mask]:
    """Algorithm 3's chain in which missiles are met in this order, from the task without any to that with all of it."""
    every = frozenset(range(1, missiles + 1))
    return [every - frozenset(met[:count]) for count in range(len(met) + 1)]


def plan(missiles: int) -> Plan:
    """How to draw the 2^n tasks of n missiles."""
    levels, chain = masks_by_level(missiles), nested_chain(missiles)
    if missiles <= ROOMY_UP_TO:
        places = {mask: place for level, masks in enumerate(levels) for mask, place in _column(level, masks)}
        return Plan(True, True, places, dict.fromkeys(places, WIDE))
    places, sizes, style = {}, {}, _style(missiles)
    for level, masks in enumerate(levels):
        others = [mask for mask in masks if mask not in chain]
        linked = [mask for mask in masks if mask in chain]
        places |= {mask: (float(level), CHAIN_Y) for mask in linked} | dict(_block(level, others, missiles, style))
        sizes |= dict.fromkeys(linked, CHAIN) | dict.fromkeys(others, style.size)
    return Plan(False, missiles <= NAMED_UP_TO, places, sizes)


def _style(missiles: int) -> Style:
    if missiles <= NAMED_UP_TO:
        return Style((35.0, 20.0), (38.0, 25.0), 2)
    return Style((14.0, 14.0), (18.0, 19.0), 4) if missiles == 7 else Style((12.0, 12.0), (15.5, 16.2), 4)


def _column(level: int, masks: Sequence[Mask]) -> Iterator[tuple[Mask, Place]]:
    gap = 1.0 / max(len(masks), ROOMY_UP_TO)
    top = gap * (len(masks) - 1) / 2
    for row, mask in enumerate(masks):
        yield mask, (float(level), top - gap * row)


def _block(level: int, masks: Sequence[Mask], missiles: int, style: Style) -> Iterator[tuple[Mask, Place]]:
    """Tasks of one level in rows below the chain; the last row may be shorter."""
    columns = min(style.columns, max(1, math.ceil(math.sqrt(len(masks)))))
    rows = math.ceil(len(masks) / columns)
    across, up = style.pitch[0] * (missiles + 1.2) / PLOT[0], style.pitch[1] / PLOT[1]
    for number, mask in enumerate(masks):
        row, column = divmod(number, columns)
        yield mask, (level + across * (column - (columns - 1) / 2), BLOCK_Y + up * ((rows - 1) / 2 - row))
