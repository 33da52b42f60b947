"""Runs put together by what they have in common, with the interval of their success over seeds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from agents.statistics import bootstrap
from workbench.run_index.record import UNREADABLE, RunRecord
from workbench.scenarios import scenario_label

REPLICATES = 1000
MOST_DOTS = 60


@dataclass(frozen=True)
class Group:
    """Runs with something in common."""

    key: str
    records: tuple[RunRecord, ...]

    @property
    def successes(self) -> tuple[float, ...]:
        """Best held-out success rates of those that have one, 0..1."""
        return tuple(record.success for record in self.records if record.success is not None)

    def interval(self) -> tuple[float, float, float] | None:
        """Interquartile mean of the success rates and its 95 % interval by bootstrap; None where no run has one.

        Runs of different tasks are strata: none gains weight by being drawn more often. NaN bounds for a single run.
        """
        strata: dict[tuple[str, str], list[float]] = {}
        for record in self.records:
            if record.success is not None:
                strata.setdefault((record.scenario, record.task), []).append(record.success)
        return _interval(tuple(tuple(values) for values in strata.values())) if strata else None


@lru_cache(maxsize=512)
def _interval(strata: tuple[tuple[float, ...], ...]) -> tuple[float, float, float]:
    value, low, high = bootstrap(strata, replicates=REPLICATES)
    return float(value), float(low), float(high)


def grouped(records: Iterable[RunRecord], by: str, falling: bool | None = None) -> list[Group]:
    """The groups of these records, each in their order.

    Args:
        records: the runs.
        by: one of the keys of `runs_settings.GROUPS`.
        falling: order the groups by their success, falling or rising; None orders them by name.
    """
    members: dict[str, list[RunRecord]] = {}
    for record in records:
        members.setdefault(key_of(record, by), []).append(record)
    groups = [Group(key, tuple(members[key])) for key in sorted(members)]
    if falling is None:
        return groups
    known = [(group, interval) for group in groups if (interval := group.interval()) is not None]
    best_first = [group for group, _ in sorted(known, key=lambda pair: pair[1][0], reverse=falling)]
    return best_first + [group for group in groups if group not in best_first]


def key_of(record: RunRecord, by: str) -> str:
    """What a run is put together by."""
    if record.problem:
        return UNREADABLE
    if by == "settings":
        guide = f"guide {record.guide}" if record.guide else ""
        words = (record.variant, record.profile, record.task, scenario_label(record.scenario), guide)
        return " · ".join(filter(None, words))
    return str(getattr(record, by))


def dots(values: Sequence[float]) -> list[float]:
    """At most MOST_DOTS of the values, evenly spread over the sorted ones: what a strip of dots can show."""
    if len(values) <= MOST_DOTS:
        return [round(value, 4) for value in values]
    return [round(float(value), 4) for value in np.quantile(values, np.linspace(0, 1, MOST_DOTS))]
