"""The static picture of a flight holds what the Fly page shows of it, in the same colours."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from layouts.flight_figure import LEAD_S, engagement_s, flight_figure
from layouts.theme import GATE, POLICY_A, missile_colour
from sim.task import Task
from sim.trajectory import fly
from sim.world import Outcome
from tests.engagements import changed, drag
from tests.layouts.sample import END_S, sample_flight


def panel(figure: Figure, y_label: str) -> Axes:
    (found,) = [axes for axes in figure.axes if axes.get_ylabel() == y_label]
    return found


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


def curves(axes: Axes) -> dict[str, np.ndarray]:
    """Points [N, 2] of every curve of more than two points, by colour."""
    return {str(line.get_color()): line.get_xydata() for line in axes.lines if len(line.get_xydata()) > 2}


def written(figure: Figure) -> list[tuple[str, Bbox]]:
    """Words of the title, the list of events and the legend, and where they are on the sheet."""
    figure.canvas.draw()
    texts = [*figure.texts, *figure.axes[1].texts, *figure.legends[0].get_texts()]
    return [(text.get_text(), text.get_window_extent()) for text in texts]


@pytest.mark.parametrize("outcome", [Outcome.EXIT, Outcome.SHOT_DOWN, Outcome.TIMEOUT])
def test_the_title_says_who_flew_what_and_how_it_ended(outcome: Outcome) -> None:
    flight = sample_flight(outcome=outcome)
    told = " ".join(words(flight_figure(flight)))
    assert "sample on target, seed 3" in told
    assert {Outcome.EXIT: "Reached the exit", Outcome.SHOT_DOWN: "Shot down by missile 4"}.get(outcome, "time") in told
    assert f"return {flight.episode_return:.1f}" in told


def test_azimuths_are_drawn_over_lines_at_plus_and_minus_90_degrees() -> None:
    axes = panel(flight_figure(sample_flight()), "azimuth [deg]")
    dotted = {line.get_ydata()[0] for line in axes.lines if line.get_linestyle() == (0, (1, 2)) or line.is_dashed()}
    assert dotted == {-90.0, 90.0}
    seen = curves(axes)[missile_colour(1)]
    at_quarter = np.nanargmin(np.abs(seen[:, 0] - 45.0))
    assert seen[at_quarter, 1] == pytest.approx(90.0, abs=1.0)


def test_tracks_gate_and_field_are_on_the_map_in_equal_scales() -> None:
    flight = sample_flight()
    axes = panel(flight_figure(flight), "y [km]")
    track = curves(axes)[POLICY_A]
    assert track[0] == pytest.approx(flight.evader.position_m[0, :2] / 1e3)
    assert axes.get_aspect() == 1.0
    field = flight.task.scenario.battlefield
    gates = [line.get_xydata() for line in axes.lines if line.get_color() == GATE and line.get_linewidth() > 4]
    assert np.allclose(gates[0][:, 0], field.length_m / 2e3)
    assert np.ptp(gates[0][:, 1]) == pytest.approx(2 * field.exit_half_width_m / 1e3)


def test_a_flight_that_leaves_the_field_stays_on_the_map() -> None:
    flight = sample_flight(outcome=Outcome.LEFT_FIELD)
    away = flight.evader.position_m + np.array([0.0, 90e3, 0.0])
    axes = panel(flight_figure(replace(flight, evader=replace(flight.evader, position_m=away))), "y [km]")
    assert axes.get_ylim()[1] > 90.0


def test_every_panel_shows_every_missile_and_speeds_and_ranges_both_aircraft() -> None:
    figure = flight_figure(sample_flight())
    for label in ("azimuth [deg]", "range [km]", "speed [m/s]", "cumulative reward", "y [km]"):
        assert {missile_colour(m) for m in (1, 2, 3, 4)} <= set(curves(panel(figure, label))), label


def test_the_return_ends_at_the_episodes_return() -> None:
    flight = sample_flight()
    axes = panel(flight_figure(flight), "cumulative reward")
    (line,) = [line for line in axes.lines if line.get_label() == "return"]
    assert line.get_ydata()[0] == 0.0
    assert line.get_ydata()[-1] == pytest.approx(flight.episode_return)


def test_every_event_is_listed_and_marked() -> None:
    flight = sample_flight(outcome=Outcome.SHOT_DOWN)
    figure = flight_figure(flight)
    assert {event.text for event in flight.events} <= set(words(figure))
    times = {line.get_xdata()[0] for line in panel(figure, "speed [m/s]").lines}
    assert {event.time_s for event in flight.events if event.kind != "closest"} <= times


def test_masked_missiles_are_nowhere() -> None:
    figure = flight_figure(sample_flight(masked=frozenset({2, 4})))
    assert "missile 1" in words(figure)
    assert not [text for text in words(figure) if "missile 2" in text or "missile 4" in text]


def test_without_missiles_the_whole_flight_is_shown() -> None:
    flight = sample_flight(masked=frozenset({1, 2, 3, 4}))
    assert engagement_s(flight) == pytest.approx((0.0, 1.01 * END_S))
    assert "no missiles" in " ".join(words(flight_figure(flight)))


def test_the_engagement_begins_before_the_first_launch_and_ends_after_the_last_missile() -> None:
    flight = sample_flight(masked=frozenset({4}))
    assert engagement_s(flight) == (30.0 - LEAD_S, 150.0 + LEAD_S)


EIGHT = Task(changed(launch={"missiles": 8, "interval_s": 6.0}))


@pytest.mark.parametrize("missiles", [4, 8])
def test_no_words_lie_on_others_and_all_are_on_the_sheet(missiles: int) -> None:
    flight = sample_flight() if missiles == 4 else fly(EIGHT, drag, "drag", 1)
    figure = flight_figure(replace(flight, policy="a policy with a long name " * 6))
    places = written(figure)
    assert [(a, b) for n, (a, one) in enumerate(places) for b, two in places[:n] if one.overlaps(two)] == []
    assert [words for words, box in places if box.x0 < 0 or box.x1 > figure.bbox.x1] == []


def test_names_and_events_are_words_and_never_mathematics() -> None:
    flight = sample_flight()
    event = replace(flight.events[0], text="missile $x_1$")
    figure = flight_figure(replace(flight, policy="$x_1$", events=(event,)))
    texts = [text for text in figure.findobj(Text) if "$x_1$" in text.get_text()]
    assert [text.get_parse_math() for text in texts] == [False, False]


def test_neither_importing_nor_drawing_touches_the_global_state_of_pyplot() -> None:
    code = (
        "import sys, layouts.flight_figure; assert 'matplotlib' not in sys.modules;"
        "from tests.layouts.sample import sample_flight; layouts.flight_figure.picture(sample_flight(), 'png');"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, timeout=120)
