"""Statistics over seeds: interquartile mean and stratified bootstrap intervals.

The practice of Agarwal et al. (2021), "Deep reinforcement learning at the edge of the statistical precipice": with
few seeds the mean hangs on one outlier and the median forgets most of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Values = NDArray[np.float64]
Statistic = Callable[[Values], Values]
"""Runs `[..., n]` -> their summary `[...]`."""

CUT: Final = 0.25
REPLICATES: Final = 2_000
LEVEL: Final = 0.95
BLOCK: Final = 2_000_000
"""Numbers resampled at a time: bounds the memory, changes nothing."""


class Interval(NamedTuple):
    """A value and the bounds of its interval, arrays of one shape; NaN bounds where one run tells nothing."""

    value: Values
    low: Values
    high: Values


def interquartile_mean(runs: ArrayLike) -> Values:
    """Mean of the middle half of the runs `[..., n]` -> `[...]`.

    A quarter of them, rounded down, is left out at either end: of 10 runs the 6 in the middle count, of 3 or fewer
    all.

    Raises:
        ValueError: there is no run.
    """
    values = np.asarray(runs, dtype=np.float64)
    count = values.shape[-1]
    if count == 0:
        raise ValueError("the interquartile mean of no runs is not defined")
    cut = int(CUT * count)
    return np.sort(values, axis=-1)[..., cut : count - cut].mean(axis=-1)


def bootstrap(
    strata: Sequence[ArrayLike],
    statistic: Statistic = interquartile_mean,
    *,
    replicates: int = REPLICATES,
    seed: int = 0,
) -> Interval:
    """A statistic of all runs and its 95 % percentile interval by stratified bootstrap.

    Each replicate draws, with replacement, as many runs from every stratum (task) as it has, so that no task gains
    or loses weight; the statistic is then taken of all drawn runs together.

    Args:
        strata: runs of each stratum, `[..., n_k]`; the leading axes (times of a curve) are the same for all, and a
            run is drawn as a whole.
        statistic: summary over the last axis; the interquartile mean by default.
        replicates: number of replicates.
        seed: seed of the drawing; the same one gives the same interval.

    Returns:
        Value and bounds `[...]`. With fewer than two runs in every stratum the bounds are NaN.
    """
    runs = [np.asarray(stratum, dtype=np.float64) for stratum in strata]
    value = np.asarray(statistic(np.concatenate(runs, axis=-1)))
    if max(stratum.shape[-1] for stratum in runs) < 2:
        return Interval(value, np.full_like(value, np.nan), np.full_like(value, np.nan))
    generator = np.random.default_rng(seed)
    counts = [stratum.shape[-1] for stratum in runs]
    chosen = [generator.integers(count, size=(replicates, count)) for count in counts]
    step = max(BLOCK // sum(stratum.size for stratum in runs), 1)
    drawn = np.concatenate([
        statistic(_resampled(runs, [choice[start : start + step] for choice in chosen]))
        for start in range(0, replicates, step)
    ])  # fmt: skip
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.quantile(drawn, [tail, 1.0 - tail], axis=0)
    return Interval(value, low, high)


def _resampled(runs: list[Values], chosen: list[NDArray[np.int64]]) -> Values:
    """The chosen runs of every stratum, `[replicates, ..., n]`."""
    drawn = [np.moveaxis(stratum[..., choice], -2, 0) for stratum, choice in zip(runs, chosen, strict=True)]
    return np.concatenate(drawn, axis=-1)
