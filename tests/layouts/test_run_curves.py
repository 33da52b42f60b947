"""Curves of runs: positions go on through stages, smoothing is an unbiased mean, figures frame what they show."""

from __future__ import annotations

import numpy as np
import pytest

from layouts.run_curves import Level, RunCurve, curve_figure, positions, smoothed
from layouts.run_difference import difference_table
from layouts.run_lineage import Link, lineage


def test_a_counter_that_starts_anew_goes_on() -> None:
    stage = np.array([0.0, 0.0, 1.0, 1.0, 1.0])
    steps = np.array([10.0, 20.0, 5.0, 10.0, 15.0])
    assert positions(stage, steps).tolist() == [10.0, 20.0, 25.0, 30.0, 35.0]


def test_a_counter_may_start_anew_within_a_stage_and_be_missing() -> None:
    # A resumed training counts its working time anew.
    stage = np.zeros(5)
    assert positions(stage, np.array([2.0, 4.0, 1.0, np.nan, 3.0])).tolist() == [2.0, 4.0, 5.0, 5.0, 7.0]
    assert positions(np.array([]), np.array([])).tolist() == []


@pytest.mark.parametrize("weight", [0.0, 0.3, 0.9])
def test_smoothing_is_the_weighted_mean_of_the_past(weight: float) -> None:
    values = np.random.default_rng(0).normal(size=30)
    weights = weight ** np.arange(30.0)
    expected = [np.average(values[: n + 1][::-1], weights=weights[: n + 1]) for n in range(30)]
    assert smoothed(values, weight) == pytest.approx(np.array(expected))


def test_a_constant_stays_what_it_is() -> None:
    assert smoothed(np.full(9, 3.0), 0.99) == pytest.approx(np.full(9, 3.0))


def _curve(y: list[float], band: bool = False) -> RunCurve:
    values = np.array(y)
    x = np.arange(1.0, len(y) + 1)
    return RunCurve("a", "#2f86ff", x, values, values, band=(values - 1, values + 1) if band else None, ends=(0,))


def test_figures_frame_curves_bands_and_levels() -> None:
    sheet = curve_figure("test")
    sheet.show([_curve([1.0, 3.0], band=True)], "return", "steps", [Level("expert", 9.0)])
    y = sheet.figure.y_range
    assert (y.start, y.end) == pytest.approx((-0.45, 9.45))
    assert sheet.figure.x_range.end == 2.0
    assert len(sheet.bands.data["xs"][0]) == 4
    assert sheet.ends.data["x"] == [1.0]
    sheet.show([_curve([0.5])], "success", "steps", rate=True)
    assert (y.start, y.end) == (-0.02, 1.04)


def test_zooming_by_hand_is_left_alone_while_only_the_same_data_come() -> None:
    sheet = curve_figure("test")
    sheet.show([_curve([1.0, 3.0])], "", "")
    sheet.figure.x_range.update(start=0.5, end=0.7)
    sheet.show([_curve([1.0, 3.0])], "", "")
    assert (sheet.figure.x_range.start, sheet.figure.x_range.end) == (0.5, 0.7)


def test_nothing_to_show_is_an_empty_figure() -> None:
    sheet = curve_figure("test")
    sheet.show([], "", "")
    assert len(sheet.points.data["x"]) == 0


def test_only_what_differs_is_listed_unless_asked() -> None:
    fields = {"seed": ["1", "2"], "variant": ["<b>", "<b>"]}
    titles = [("<i>one</i>", "#111111"), ("two", "#222222")]
    assert "variant" not in difference_table(titles, fields)
    shown = difference_table(titles, fields, every_field=True)
    assert "&lt;b&gt;" in shown
    assert "<i>one" not in shown
    assert "configured alike" in difference_table(titles, {"variant": ["x", "x"]})


def test_lineage_escapes_titles_and_addresses() -> None:
    shown = lineage([Link("<b>", href='/runs?run="x')], [Link("here", here=True)], [Link("<i>", href="/runs?run=y")])
    assert "<b><b>" not in shown
    assert "&lt;b&gt;" in shown
    assert 'run=&quot;x"' in shown
    assert shown.index("here") < shown.index("&lt;i&gt;")
