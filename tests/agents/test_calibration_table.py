"""A line of the calibration table: accepted or not, how sure that is, and how far off it lies. All by hand."""

from __future__ import annotations

import math

import pytest

from agents.calibration_table import UNMEASURED, Calibration, LeftOut, Target, mean_interval

NAN = math.nan


def line(value: float, ci95: tuple[float, float] = (NAN, NAN), scale: float = 1.0) -> Target:
    """A value that is accepted from 0.59 to 0.65."""
    return Target("x", value, 0.59, 0.65, ci95, scale)


def table(*targets: Target) -> Calibration:
    """A calibration with these lines."""
    return Calibration("drill", 100, 7, targets, (LeftOut("y", "no use"),))


@pytest.mark.parametrize(("value", "ok"), [(0.59, True), (0.65, True), (0.589, False), (0.651, False), (NAN, False)])
def test_a_target_is_met_within_its_bounds_only(value: float, ok: bool) -> None:
    assert line(value).ok is ok
    assert (line(value).shortfall == 0.0) is ok


@pytest.mark.parametrize(
    ("value", "ci95", "verdict"),
    [
        (0.62, (0.60, 0.64), "ok"),
        (0.62, (0.59, 0.65), "ok"),
        (0.62, (0.58, 0.64), "undecided"),
        (0.62, (0.60, 0.66), "undecided"),
        (0.66, (0.64, 0.68), "undecided"),
        (0.57, (0.55, 0.59), "undecided"),
        (0.57, (0.55, 0.589), "not ok"),
        (0.70, (0.66, 0.74), "not ok"),
        (0.62, (NAN, NAN), "undecided"),
        (0.70, (NAN, NAN), "undecided"),
        (NAN, (NAN, NAN), "not ok"),
    ],
)
def test_a_verdict_is_given_only_where_the_whole_interval_agrees(
    value: float, ci95: tuple[float, float], verdict: str
) -> None:
    assert line(value, ci95).verdict == verdict


def test_the_shortfall_is_the_distance_to_what_is_accepted() -> None:
    assert line(0.50).shortfall == pytest.approx(0.09)
    assert line(0.70).shortfall == pytest.approx(0.05)
    assert Target("length [s]", 835.0, 850.0, 1000.0, scale=150.0).shortfall == pytest.approx(0.1)
    assert line(NAN).shortfall == UNMEASURED


def test_the_doubt_is_how_far_the_interval_reaches_out() -> None:
    assert line(0.62, (0.60, 0.64)).doubt == 0.0
    assert line(0.62, (0.57, 0.66)).doubt == pytest.approx(0.02 + 0.01)
    assert line(0.62).doubt == UNMEASURED


@pytest.mark.parametrize(
    ("values", "shortfall"),
    [((), 0.0), ((0.6, 0.65), 0.0), ((0.6, 0.66), 0.01), ((0.5, 0.7, 0.6), 0.14), ((NAN, 0.58), 1.01)],
)
def test_the_shortfall_of_a_table_is_zero_exactly_when_all_targets_are_ok(
    values: tuple[float, ...], shortfall: float
) -> None:
    measured = table(*map(line, values))
    assert measured.shortfall == pytest.approx(shortfall, abs=1e-12)
    assert (measured.shortfall == 0.0) is measured.ok


def test_a_table_is_missed_only_when_a_line_surely_is() -> None:
    assert not table(line(0.66, (0.64, 0.68)), line(0.6, (0.6, 0.6))).missed
    assert table(line(0.62, (0.6, 0.64)), line(0.66, (0.655, 0.665))).missed


def test_the_json_keeps_what_is_promised_and_adds_the_interval() -> None:
    figures = table(line(0.66, (0.64, 0.68))).to_json()
    assert figures["targets"] == [
        {
            "name": "x",
            "value": 0.66,
            "low": 0.59,
            "high": 0.65,
            "ok": False,
            "ci95": [0.64, 0.68],
            "verdict": "undecided",
        }
    ]
    assert figures["left_out"] == [{"name": "y", "reason": "no use"}]
    assert (figures["scenario"], figures["episodes"], figures["seed"]) == ("drill", 100, 7)
    assert figures["shortfall"] == pytest.approx(0.01)


def test_the_interval_of_a_mean() -> None:
    # 1, 2, 3, 4: mean 2.5, s = sqrt(5/3) = 1.29099, half width 1.959964 x 1.29099 / 2 = 1.26515.
    assert mean_interval([1.0, 2.0, 3.0, 4.0]) == pytest.approx((2.5 - 1.26515, 2.5 + 1.26515), abs=1e-5)
    assert mean_interval([3.0, 3.0]) == (3.0, 3.0)
    assert all(math.isnan(end) for end in (*mean_interval([1.0]), *mean_interval([])))
