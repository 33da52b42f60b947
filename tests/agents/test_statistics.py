"""Interquartile mean and bootstrap: numbers worked out by hand, every resample enumerated, and what they promise."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from agents import statistics
from agents.statistics import bootstrap, interquartile_mean


@pytest.mark.parametrize(
    ("runs", "expected"),
    [
        # By hand: of ten, two fall away at either end and 3 + 4 + 5 + 6 + 7 + 80 are left.
        ([1, 80, 3, 4, 5, 6, 7, 2, 90, 100], 105 / 6),
        ([0.0, 0.2, 0.6, 1.0], 0.4),
        ([0.0, 0.25, 1.0, 0.5, 0.75], 0.5),
        ([0.3, 0.9, 0.6], 0.6),
        ([0.3], 0.3),
    ],
)
def test_the_middle_half_counts(runs: list[float], expected: float) -> None:
    assert interquartile_mean(runs) == pytest.approx(expected)


def test_an_outlier_among_ten_does_not_matter() -> None:
    runs = np.linspace(0.8, 0.9, 10)
    ruined = np.append(runs[1:], -1e6)
    assert abs(interquartile_mean(ruined) - interquartile_mean(runs)) < 0.02
    assert abs(ruined.mean() - runs.mean()) > 1e4  # what the mean would say


def test_no_runs_have_no_mean() -> None:
    with pytest.raises(ValueError, match="no runs"):
        interquartile_mean([])


def test_leading_axes_are_summarised_one_by_one() -> None:
    curves = np.random.default_rng(0).normal(size=(5, 10))
    assert interquartile_mean(curves).tolist() == [interquartile_mean(row) for row in curves]


def every_resample(strata: list[list[float]]) -> np.ndarray:
    """The interquartile mean of every set that can be drawn, each equally likely."""
    draws = [list(product(stratum, repeat=len(stratum))) for stratum in strata]
    return np.array([interquartile_mean(np.concatenate(one)) for one in product(*draws)])


@pytest.mark.parametrize("strata", [[[0.1, 0.5, 0.6, 0.9]], [[0.0, 0.4, 1.0], [10.0, 12.0]]])
def test_the_interval_is_that_of_all_resamples(strata: list[list[float]]) -> None:
    exact = every_resample(strata)
    interval = bootstrap(strata, replicates=40_000)
    assert interval.value == interquartile_mean(np.concatenate(strata))
    # The exact distribution has steps: the bound is the step that crosses 2.5 % and 97.5 %.
    for bound, share in ((interval.low, 0.025), (interval.high, 0.975)):
        assert (exact < bound - 1e-9).mean() - 0.005 < share < (exact < bound + 1e-9).mean() + 0.005


def test_strata_keep_their_weight() -> None:
    # Two tasks far apart, no spread within: drawn together their mean would swing, drawn by task it cannot.
    easy, hard = [1.0] * 5, [0.0] * 5
    stratified, mixed = bootstrap([easy, hard]), bootstrap([easy + hard])
    assert (stratified.low, stratified.high) == (0.5, 0.5)
    assert mixed.high - mixed.low > 0.5


def test_the_interval_of_normal_runs_covers_the_truth_about_as_often_as_it_says() -> None:
    generator, trials = np.random.default_rng(3), 300
    intervals = [bootstrap([generator.normal(size=30)], replicates=400, seed=trial) for trial in range(trials)]
    covered = np.mean([interval.low <= 0.0 <= interval.high for interval in intervals])
    assert 0.88 < covered < 0.98


def test_a_curve_is_drawn_as_a_whole() -> None:
    # Every run is one constant: if times were drawn apart, bounds would differ from time to time.
    curves = np.tile(np.random.default_rng(1).normal(size=6), (4, 1))
    interval = bootstrap([curves])
    assert interval.low.shape == (4,)
    assert np.ptp(interval.low) == np.ptp(interval.high) == 0.0


def test_one_run_has_no_interval() -> None:
    interval = bootstrap([[0.7]])
    assert interval.value == 0.7
    assert np.isnan([interval.low, interval.high]).all()


def test_the_same_seed_gives_the_same_interval_in_blocks_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = list(np.random.default_rng(2).normal(size=(2, 8)))
    whole = bootstrap(runs)
    assert bootstrap(runs) == whole
    assert bootstrap(runs, seed=1) != whole
    monkeypatch.setattr(statistics, "BLOCK", 800)
    assert bootstrap(runs) == whole
