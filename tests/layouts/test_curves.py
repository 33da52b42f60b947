"""Ranges, speeds, rewards and tracks say what the flight says."""

from __future__ import annotations

import numpy as np
import pytest

from layouts.map2d import map_chart, map_columns, map_ranges
from layouts.ranges import range_columns
from layouts.rewards import reward_columns
from layouts.speeds import speed_columns
from sim.world import Outcome
from tests.layouts.sample import SPEED_M_S, sample_flight


def test_the_closest_approach_survives_thinning() -> None:
    flight = sample_flight(per_second=100)
    columns = range_columns(flight)
    assert np.nanmin(columns["missile_2_km"]) == pytest.approx(np.nanmin(flight.missiles[1].range_m) / 1e3)


def test_the_interceptors_distance_is_in_kilometres() -> None:
    assert range_columns(sample_flight())["interceptor_km"][0] == pytest.approx(np.hypot(200.0, 20.0))


def test_a_missile_has_a_speed_only_in_flight() -> None:
    columns = speed_columns(sample_flight())
    assert np.all(columns["evader_m_s"] == SPEED_M_S)
    assert np.isnan(columns["missile_4_m_s"][0])
    assert np.nanmax(columns["missile_4_m_s"]) == 800.0


def test_the_last_total_is_the_episode_return() -> None:
    flight = sample_flight()
    columns = reward_columns(flight)
    assert columns["total"][-1] == pytest.approx(flight.episode_return)
    assert columns["goal"][-1] == 400.0
    assert columns["missile_3"][-1] == 50.0


def test_masked_missiles_have_no_reward_curve() -> None:
    assert "missile_4" not in reward_columns(sample_flight(masked=frozenset({4})))


def test_tracks_are_kilometres_and_empty_outside_the_flight() -> None:
    columns = map_columns(sample_flight())
    assert columns["evader_x_km"][0] == -100.0
    assert np.isnan(columns["missile_1_x_km"][0])


def test_the_map_shows_the_whole_battlefield_and_marks_a_hit() -> None:
    flight = sample_flight(outcome=Outcome.SHOT_DOWN)
    field = flight.task.scenario.battlefield
    x, _y = map_ranges(field)
    assert x.start < -field.length_m / 2e3
    chart = map_chart(field, range(1, 5))
    chart.show(flight, "A")
    assert chart.ends is not None
    assert list(chart.ends.data["mark_marker"]).count("x") == 1
