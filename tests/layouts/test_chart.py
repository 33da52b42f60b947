"""Curves stay light, show any flight in place, and can be taken home."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from bokeh.models import CustomAction, SaveTool

from layouts import azimuth, closure, energy, ranges, rewards, speeds
from layouts.chart import CURSOR_TAG, MAX_POINTS, OVER_TIME_TAG, FlightChart, thin_index
from tests.layouts.sample import sample_flight

CHARTS = [
    azimuth.azimuth_chart, ranges.range_chart, closure.closure_chart, speeds.speed_chart, energy.energy_chart,
    rewards.reward_chart,
]  # fmt: skip


def test_thinning_keeps_the_ends_the_asked_for_and_the_limit() -> None:
    index = thin_index(24_001, keep=[77, 78])
    assert {0, 77, 78, 24_000} <= set(index)
    assert len(index) <= MAX_POINTS
    assert np.all(np.diff(index) > 0)


def test_short_flights_are_not_thinned() -> None:
    assert np.array_equal(thin_index(5), np.arange(5))


@pytest.mark.parametrize("make", CHARTS)
def test_a_chart_shows_a_flight_with_few_points(make: Callable[[Sequence[int]], FlightChart]) -> None:
    chart = make(range(1, 5))
    chart.show(sample_flight(per_second=100), "A")
    lengths = {len(values) for values in chart.source.data.values()}
    assert len(lengths) == 1
    assert max(lengths) <= MAX_POINTS + 8
    assert chart.figure.title.text == "A"


@pytest.mark.parametrize("make", CHARTS)
def test_masked_missiles_leave_the_legend_and_come_back(make: Callable[[Sequence[int]], FlightChart]) -> None:
    chart = make(range(1, 5))
    chart.show(sample_flight(masked=frozenset({3, 4})))
    shown = [item.label.value for item in chart.figure.legend[0].items if item.visible]
    assert "missile 2" in shown
    assert "missile 3" not in shown
    chart.show(sample_flight())
    assert all(item.visible for item in chart.figure.legend[0].items)


@pytest.mark.parametrize("make", CHARTS)
def test_every_chart_has_a_clock_cursor_and_both_downloads(make: Callable[[Sequence[int]], FlightChart]) -> None:
    figure = make(range(1, 5)).figure
    assert {CURSOR_TAG, OVER_TIME_TAG} <= set(figure.tags)
    assert {"tap", "pan"} <= set(figure.js_event_callbacks)
    assert any(isinstance(tool, SaveTool) for tool in figure.tools)
    assert any(isinstance(tool, CustomAction) and "CSV" in tool.description for tool in figure.tools)
