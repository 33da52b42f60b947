"""Fig. 12: azimuths in degrees, broken where they wrap, marked where they end."""

from __future__ import annotations

import numpy as np
from bokeh.models import Span

from layouts.azimuth import azimuth_chart, azimuth_columns, end_columns, wrap_gaps
from sim.world import Outcome
from tests.layouts.sample import sample_flight


def test_a_jump_over_180_degrees_gets_one_row_without_a_value() -> None:
    columns = wrap_gaps({"time_s": np.array([0.0, 1.0, 2.0]), "m": np.array([170.0, -170.0, -160.0])})
    assert np.array_equal(columns["time_s"], [0.0, 0.5, 1.0, 2.0])
    assert np.array_equal(columns["m"], [170.0, np.nan, -170.0, -160.0], equal_nan=True)


def test_the_other_missiles_go_on_through_a_gap() -> None:
    columns = wrap_gaps({"time_s": np.array([0.0, 1.0]), "m": np.array([179.0, -179.0]), "n": np.array([10.0, 20.0])})
    assert np.array_equal(columns["n"], [10.0, 15.0, 20.0])


def test_no_missile_at_all_is_fine() -> None:
    columns = azimuth_columns(sample_flight(masked=frozenset({1, 2, 3, 4})))
    assert list(columns) == ["time_s"]


def test_azimuths_are_degrees_and_only_there_in_flight() -> None:
    columns = azimuth_columns(sample_flight())
    seen = columns["missile_1_deg"]
    at_quarter = np.argmin(np.abs(columns["time_s"] - 45.0))
    assert abs(seen[at_quarter] - 90.0) < 1.0
    assert np.isnan(seen[columns["time_s"] < 29.9]).all()
    assert np.nanmax(np.abs(seen)) <= 180.0


def test_no_line_is_drawn_across_the_wrap() -> None:
    for name, values in azimuth_columns(sample_flight()).items():
        if name != "time_s":
            assert not np.any(np.abs(np.diff(values)) > 180.0)


def test_ends_say_evaded_or_hit() -> None:
    ends = end_columns(sample_flight(outcome=Outcome.SHOT_DOWN))
    assert ends["end_marker"] == ["circle", "circle", "circle", "x"]
    assert ends["end_missile"] == [1, 2, 3, 4]


def test_the_figure_has_lines_at_plus_and_minus_90_degrees() -> None:
    figure = azimuth_chart(range(1, 5)).figure
    dotted = {span.location for span in figure.select(Span) if span.line_dash in ("dotted", [2, 4])}
    assert dotted == {-90.0, 90.0}
