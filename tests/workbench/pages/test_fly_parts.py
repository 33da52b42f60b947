"""Cards, events and curves of the Fly page."""

from __future__ import annotations

from pathlib import Path

import pytest

from layouts.captions import clock_text, distance_text, outcome_text
from sim.scenario_file import load_scenario
from sim.world import Outcome
from tests.layouts.sample import END_S, sample_flight
from workbench.pages.fly_cards import flight_card
from workbench.pages.fly_events import event_rows
from workbench.pages.fly_figures import ChartPairs, Pair
from workbench.runs import RunStore

COLOURS = {"A": "#000001", "B": "#000002"}


def test_a_card_says_how_it_ended_and_what_it_was_worth() -> None:
    flight = sample_flight(outcome=Outcome.SHOT_DOWN)
    card = flight_card("A", "anybody", flight, "#123456")
    assert "Shot down by missile 4" in card
    assert "3 of 4" in card
    assert f"{flight.episode_return:.1f}" in card


def test_a_label_cannot_bring_markup_along() -> None:
    card = flight_card("A", '<img src=x onerror="alert(1)">', sample_flight(), "#123456")
    assert "<img" not in card
    assert "&lt;img" in card


@pytest.mark.parametrize("outcome", [o for o in Outcome if o is not Outcome.FLYING])
def test_every_outcome_has_words(outcome: Outcome) -> None:
    assert outcome_text(sample_flight(outcome=outcome))[0] in "✓✗"


def test_times_and_distances_read_as_people_write_them() -> None:
    assert clock_text(869.0) == "14:29"
    assert distance_text(18.4) == "18 m"
    assert distance_text(5912.0) == "5.9 km"
    assert distance_text(float("nan")) == "–"


def test_events_of_both_flights_are_in_order_and_carry_their_flight() -> None:
    rows = event_rows({"A": sample_flight(), "B": sample_flight(masked=frozenset({1}))}, COLOURS)
    times = [row["time"] for row in rows]
    assert times == sorted(times)
    assert {row["who"] for row in rows} == {"A", "B"}
    assert rows[-1]["kind"] == "exit"


def test_both_figures_of_a_pair_have_one_scale() -> None:
    charts = ChartPairs(load_scenario())
    pair = Pair(sample_flight(), sample_flight(masked=frozenset({3, 4})), "A · one", "B · other")
    for title in charts.titles:
        both = charts.pair(title)
        both.show(pair)
        assert both.a.figure.x_range is both.b.figure.x_range
        assert both.a.figure.title.text == "A · one"
    assert charts.pair("Range").a.figure.x_range.end == END_S


def test_figure_12_shows_the_time_in_which_missiles_fly() -> None:
    charts = ChartPairs(load_scenario())
    azimuths = charts.pair("Azimuth")
    azimuths.show(Pair(sample_flight(), sample_flight(), "A", "B"))
    assert azimuths.x_range is not None
    assert (azimuths.x_range.start, azimuths.x_range.end) == (15.0, 195.0)
    assert azimuths.x_range.bounds == (0.0, END_S)


def test_without_missiles_the_whole_flight_is_shown() -> None:
    flight = sample_flight(masked=frozenset({1, 2, 3, 4}))
    assert Pair(flight, flight, "A", "B").engagement_s == (0.0, END_S)


def test_both_policies_start_from_the_same_state(tmp_path: Path) -> None:
    from workbench.pages.fly_flights import fly_both
    from workbench.pages.fly_settings import FlySettings

    a, b = fly_both(FlySettings("expert-navigation", "expert-dragging", frozenset({4}), 5), RunStore(tmp_path))
    assert (a.evader.position_m[0] == b.evader.position_m[0]).all()
    assert (a.interceptor.position_m[0] == b.interceptor.position_m[0]).all()
    assert a.policy == "expert-navigation"
    assert [m.number for m in b.missiles] == [1, 2, 3]
