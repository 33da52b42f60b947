"""Paired comparison of two policies that flew the same engagements: who won which, and by how much."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation
from agents.statistics import Interval, bootstrap
from agents.task import BoolArray, IntArray
from workbench.comparison.work import ComparisonError


@dataclass(frozen=True)
class PairedFigures:
    """Policy A against policy B on the same initial states."""

    both: int
    """Engagements that both won."""
    only_a: int
    only_b: int
    neither: int
    success_difference: tuple[float, float, float]
    """Success rate of A less that of B, with its paired bootstrap 95 % interval: value, low, high."""
    return_difference: tuple[float, float, float]
    """Mean return of A less that of B, likewise."""
    p_value: float
    """Exact two-sided McNemar test: how likely so one-sided a split of the engagements that only one of them won is, if
    either were as likely to win them."""

    @property
    def episodes(self) -> int:
        """How many engagements both flew."""
        return self.both + self.only_a + self.only_b + self.neither


def paired(a: Evaluation, b: Evaluation) -> PairedFigures:
    """Compare engagement by engagement.

    Raises:
        ComparisonError: they did not fly the same engagements.
    """
    mine, other = _same(a, b)
    won_a, won_b = mine.success, other.success
    both, only_a, only_b, neither = (
        int(those.sum()) for those in (won_a & won_b, won_a & ~won_b, ~won_a & won_b, ~won_a & ~won_b)
    )
    success = won_a.astype(np.float64) - won_b
    returns = mine.episode_return.astype(np.float64) - other.episode_return
    differences = _difference(success), _difference(returns)
    return PairedFigures(both, only_a, only_b, neither, *differences, mcnemar(only_a, only_b))


def mcnemar(only_a: int, only_b: int) -> float:
    """Exact two-sided McNemar test of two counts: 2 P(X <= min) with X ~ binomial(sum, 1/2), at most 1."""
    total = only_a + only_b
    tail = sum(math.comb(total, k) for k in range(min(only_a, only_b) + 1))
    return min(1.0, 2 * tail / 2**total)


def episodes_won_alone(a: Evaluation, b: Evaluation) -> IntArray:
    """Numbers of the engagements that A won and B lost, ascending.

    Raises:
        ComparisonError: they did not fly the same engagements.
    """
    mine, other = _same(a, b)
    alone: BoolArray = mine.success & ~other.success
    return mine.episode[alone]


def _same(a: Evaluation, b: Evaluation) -> tuple[EpisodeResults, EpisodeResults]:
    mine, other = a.results, b.results
    same = (a.mask, a.scenario, a.seed) == (b.mask, b.scenario, b.seed)
    if mine is None or other is None or not same or not np.array_equal(mine.episode, other.episode):
        raise ComparisonError(f"{a.policy} and {b.policy} did not fly the same engagements")
    return mine, other


def _difference(values: np.ndarray) -> tuple[float, float, float]:
    interval: Interval = bootstrap([values], lambda runs: runs.mean(axis=-1))
    return float(interval.value), float(interval.low), float(interval.high)
