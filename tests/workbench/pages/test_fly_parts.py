"""Cards, events and curves of the Fly page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from layouts.captions import clock_text, distance_text, outcome_text
from layouts.controls import ActionChart, GuideTrace
from layouts.theme import missile_colour
from sim.scenario_file import load_scenario
from sim.world import Outcome
from tests.layouts.sample import END_S, sample_flight
from workbench.pages.fly_cards import flight_card
from workbench.pages.fly_events import event_rows
from workbench.pages.fly_figures import ChartPairs, Pair, Sight
from workbench.pages.fly_flights import BlindPolicyError, fly_both
from workbench.pages.fly_settings import FlySettings
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


def test_both_figures_of_a_kind_have_one_scale() -> None:
    charts = ChartPairs(load_scenario())
    pair = Pair(sample_flight(), sample_flight(masked=frozenset({3, 4})), "A · one", "B · other")
    for kind in [kind for kinds in charts.tabs.values() for kind in kinds]:
        both = charts.pair(kind)
        both.show(pair)
        assert both.a.figure.x_range is both.b.figure.x_range
        assert kind == "action" or both.a.figure.y_range is both.b.figure.y_range or kind == "azimuth"
        assert both.a.figure.title.text == "A · one"


def test_curves_show_the_time_in_which_missiles_fly_or_the_whole_flights() -> None:
    charts = ChartPairs(load_scenario())
    pair = Pair(sample_flight(), sample_flight(), "A", "B")
    charts.fit_time(pair, Sight())
    assert (charts.time.start, charts.time.end) == (15.0, 195.0)
    assert charts.time.bounds == (0.0, END_S)
    charts.fit_time(pair, Sight(whole=True))
    assert (charts.time.start, charts.time.end) == (0.0, END_S)


def test_one_figure_shows_both_flights_and_takes_its_scale_from_both() -> None:
    charts = ChartPairs(load_scenario())
    near, far = sample_flight(), sample_flight(masked=frozenset({1, 2, 3, 4}))
    ranges = charts.pair("range")
    ranges.show(Pair(far, near, "A · far", "B · near"), over=True)
    (figure,) = ranges.figures(over=True)
    assert "A · far (solid)" in figure.title.text
    assert "B · near (dotted)" in figure.title.text
    assert ranges.over is not None
    assert np.isfinite(ranges.over.source.data["missile_1_km"]).any()
    assert not np.isfinite(ranges.over.first.source.data["missile_1_km"]).any()


def test_the_guide_is_drawn_beside_its_own_policy_only() -> None:
    flight = sample_flight()
    allowed = np.ones(len(flight.action_rad), dtype=bool)
    allowed[10:20] = False
    trace = GuideTrace("guide", (4,), allowed, np.full(len(allowed), 0.5))
    actions = ChartPairs(load_scenario()).pair("action")
    actions.show(Pair(flight, flight, "A", "B", guide_a=trace))
    assert isinstance(actions.a, ActionChart)
    assert isinstance(actions.b, ActionChart)
    assert np.degrees(0.5) == pytest.approx(actions.a.source.data["guide_deg"])
    assert list(actions.a.bands.data["from_s"]) == [10.0]
    assert list(actions.a.bands.data["to_s"]) == [20.0]
    assert not np.isfinite(actions.b.source.data["guide_deg"]).any()
    assert len(actions.b.bands.data["from_s"]) == 0


def test_without_missiles_the_whole_flight_is_shown() -> None:
    flight = sample_flight(masked=frozenset({1, 2, 3, 4}))
    assert Pair(flight, flight, "A", "B").engagement_s == (0.0, END_S)


def test_both_policies_start_from_the_same_state(tmp_path: Path) -> None:
    flown = fly_both(FlySettings("expert-navigation", "expert-dragging", frozenset({4}), 5), RunStore(tmp_path))
    a, b = flown.a, flown.b
    assert flown.notes == ()
    assert (a.evader.position_m[0] == b.evader.position_m[0]).all()
    assert (a.interceptor.position_m[0] == b.interceptor.position_m[0]).all()
    assert a.policy == "expert-navigation"
    assert [m.number for m in b.missiles] == [1, 2, 3]


def test_a_policy_of_another_scenario_flies_and_says_so(tmp_path: Path) -> None:
    settings = FlySettings("submas-source-2", "expert-dragging", frozenset({3, 4, 5, 6}), scenario="six-missiles")
    flown = fly_both(settings, RunStore(tmp_path))
    assert flown.a.task.scenario.name == "six-missiles"
    (note,) = flown.notes
    default, here = load_scenario().digest, load_scenario("six-missiles").digest
    assert f"'submas-source-2' was trained on scenario 'default' ({default}), not on 'six-missiles' ({here})" in note


def test_a_blind_policy_is_refused_with_the_mask_that_works(tmp_path: Path) -> None:
    store, settings = RunStore(tmp_path), FlySettings("submas-target", "submas-source-2", scenario="six-missiles")
    with pytest.raises(BlindPolicyError, match="cannot see missiles 5, 6 of this task") as refused:
        fly_both(settings, store)
    assert refused.value.masked == {3, 4, 5, 6}
    with pytest.raises(BlindPolicyError) as refused:
        fly_both(replace(settings, masked=frozenset({3, 5})), store)
    assert refused.value.masked == {3, 4, 5, 6}
    flown = fly_both(replace(settings, masked=refused.value.masked), store)
    assert [track.number for track in flown.b.missiles] == [1, 2]


def test_figures_have_a_curve_for_every_missile_of_the_scenario() -> None:
    charts = ChartPairs(load_scenario("six-missiles"))
    assert "missile_6_deg" in charts.pair("azimuth").a.source.column_names
    inks = {str(line.glyph.line_color): line.glyph.line_dash for line in charts.pair("azimuth").a.figure.renderers[:6]}
    assert list(inks) == [missile_colour(number) for number in range(1, 7)]
    assert [bool(dash) for dash in inks.values()] == [False] * 4 + [True] * 2
