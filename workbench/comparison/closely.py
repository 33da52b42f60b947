"""A closer look at two policies of a comparison: paired figures, where each survives a shot, engagements to look at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from layouts.comparison_survival import Shots
from workbench.comparison.cache import ComparisonCache
from workbench.comparison.gallery import Strip, strips
from workbench.comparison.grid import Cell, Grid
from workbench.comparison.pairs import PairedFigures, paired
from workbench.comparison.work import Work


@dataclass(frozen=True)
class Closely:
    """What is known of policy A against policy B, in particular on one task."""

    pairs: Mapping[str, PairedFigures]
    """By name of the task, where both have flown."""
    maps: Mapping[str, Shots | None]
    """Survival of each policy; None while it is not flown."""
    strips: tuple[Strip, ...]
    """Engagements of A to look at; empty while they are not flown."""
    tracks: Mapping[int, Mapping[str, Any]] | None
    """Of all engagements of the strips, by episode; None while they are not recorded."""
    wanted: tuple[Work, ...]
    """What has to be flown for everything to be there, the most important first."""


def look_closely(
    grid: Grid, task: str, policies: tuple[str, str], names: tuple[str, str], cache: ComparisonCache
) -> Closely:
    """Everything that is known of policies A and B (as in the grid, with their names), and what is not yet.

    Policies that cannot fly the task have nothing there, and nothing is wanted of them.
    """
    a, b = policies
    mine, other = grid.cell(a, task), grid.cell(b, task)
    wanted = [cell.work for cell in (mine, other) if cell.work is not None and cell.evaluation is None]
    maps, missing = _maps(grid, task, policies, cache)
    shown: tuple[Strip, ...] = ()
    tracks = None
    if mine.evaluation is not None and repeatable(mine.entry.policy):
        rival = other.evaluation if a != b else None
        shown = tuple(strips(mine.evaluation, rival, names[1]))
        work = _track_work(grid, a, task, shown)
        tracks = _tracks(work, cache)
        missing += [work] if work is not None and tracks is None else []
    return Closely(_pairs(grid, a, b), maps, shown, tracks, (*wanted, *missing))


def repeatable(policy: str) -> bool:
    """Whether a policy flies an engagement again as it flew it: the random one does not."""
    return policy != "random"


def _pairs(grid: Grid, a: str, b: str) -> dict[str, PairedFigures]:
    if a == b:
        return {}
    cells: list[tuple[str, Cell, Cell]] = [(task, grid.cell(a, task), grid.cell(b, task)) for task in grid.tasks]
    return {
        task: paired(mine.evaluation, other.evaluation)
        for task, mine, other in cells
        if mine.evaluation is not None and other.evaluation is not None
    }


def _maps(
    grid: Grid, task: str, policies: tuple[str, str], cache: ComparisonCache
) -> tuple[dict[str, Shots | None], list[Work]]:
    maps: dict[str, Shots | None] = {}
    missing = []
    for policy in policies:
        work = grid.work(policy, task, "survival")
        if work is None or not grid.cell(policy, task).task.missiles:
            maps[policy] = None
            continue
        values = cache.read(work)
        maps[policy] = None if values is None else shots_from_json(values)
        missing += [work] if values is None else []
    return maps, missing


def shots_from_json(values: Mapping[str, Any]) -> Shots:
    """The map of an envelope over launch range and aspect, as `Envelope.to_json` wrote it."""
    closest_m = np.array([[np.nan if v is None else v for v in row] for row in values["closest_m"]], dtype=float)
    x, y = (np.array(values[axis]["values"], dtype=float) for axis in "xy")
    return Shots(x, y, np.array(values["survived"], dtype=float), closest_m)


def _track_work(grid: Grid, policy: str, task: str, shown: tuple[Strip, ...]) -> Work | None:
    numbers = tuple(sorted({episode for strip in shown for episode in strip.episodes}))
    return grid.work(policy, task, "tracks", numbers=numbers) if numbers else None


def _tracks(work: Work | None, cache: ComparisonCache) -> dict[int, Mapping[str, Any]] | None:
    values = cache.read(work) if work is not None else None
    return None if values is None else {track["episode"]: track for track in values["tracks"]}
