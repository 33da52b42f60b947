"""Fig. 12: the azimuth of every missile over time, with lines at plus and minus 90 degrees."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import Span

from agents.expert import DraggingExpert
from agents.policy import bind
from layouts.azimuth import azimuth_chart, azimuth_columns
from sim.trajectory import Trajectory, fly
from tests.engagements import task, wrapped

EXPERT = DraggingExpert()
FLIGHTS = [fly(task(), bind(EXPERT, task()), EXPERT.name, seed=9, episode=e) for e in range(6)]


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: f"episode {flight.episode}")
def test_the_curves_are_what_the_policy_saw(flight: Trajectory) -> None:
    columns = azimuth_columns(flight)
    for missile in flight.missiles:
        drawn = columns[f"missile_{missile.number}_deg"]
        phi = flight.observation[:, flight.task.layout.block(missile.number)][:, 1]
        for step_s, seen in zip(flight.step_time_s, phi, strict=True):
            index = np.flatnonzero(np.isclose(columns["time_s"], step_s, atol=1e-6))
            if not len(index) or seen == np.float32(-np.pi):
                continue
            turned = np.radians(drawn[index[0]]) - seen
            assert np.isnan(turned) or abs(wrapped(turned)) < 1e-3


@pytest.mark.parametrize("flight", FLIGHTS, ids=lambda flight: f"episode {flight.episode}")
def test_a_missile_has_a_curve_while_it_flies_and_none_before(flight: Trajectory) -> None:
    columns = azimuth_columns(flight)
    for missile in flight.missiles:
        drawn = np.isfinite(columns[f"missile_{missile.number}_deg"])
        times = columns["time_s"][drawn]
        if np.isnan(missile.launch_s):
            assert not drawn.any()
        else:
            assert times.min() >= missile.launch_s - 1e-6
            assert times.min() < missile.launch_s + 1.0


def test_curves_stay_in_the_half_open_interval_and_break_where_they_wrap() -> None:
    for flight in FLIGHTS:
        columns = azimuth_columns(flight)
        for name, values in columns.items():
            if name == "time_s":
                continue
            shown = values[np.isfinite(values)]
            assert ((shown > -180.0) & (shown <= 180.0)).all()
            both = np.isfinite(values[1:]) & np.isfinite(values[:-1])
            assert (np.abs(np.diff(values))[both] <= 180.0).all()


def test_the_figure_has_lines_at_90_degrees_on_both_sides() -> None:
    figure = azimuth_chart((1, 2, 3, 4)).figure
    assert sorted(span.location for span in figure.select(Span) if span.dimension == "width")[:2] == [-90.0, 90.0]
