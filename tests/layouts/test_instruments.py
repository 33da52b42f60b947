"""Read-outs, closure, energy, loads: numbers known from formulas."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts.closure import closure_columns, closure_m_s
from layouts.controls import GuideTrace, action_columns, load_factor, prevented_bands
from layouts.energy import energy_colours, energy_height_m, energy_share
from layouts.instruments import instrument_series
from layouts.overlay import overlay
from layouts.rewards import paid_columns
from layouts.speeds import speed_chart
from layouts.theme import DARK, LIGHT, POLICY_A, POLICY_B
from sim.trajectory import BodyTrack
from sim.world import Outcome
from tests.layouts.sample import SPEED_M_S, sample_flight

GRAVITY_M_S2 = 9.80665


def test_a_missile_closes_at_the_rate_at_which_its_range_shrinks() -> None:
    columns = closure_columns(sample_flight())
    # 10 km closer in the first 30 s, 10 km farther in the next; the rest of the time it does not fly.
    at = [float(columns["missile_1_closure_m_s"][np.searchsorted(columns["time_s"], t)]) for t in (40.0, 80.0)]
    assert at == pytest.approx([1e4 / 30, -1e4 / 30], rel=1e-6)
    assert np.isnan(columns["missile_1_closure_m_s"][0])


def test_one_known_distance_has_no_rate() -> None:
    assert np.isnan(closure_m_s(np.array([np.nan, 5.0]), np.array([0.0, 1.0]))).all()


def test_a_level_turn_pulls_what_the_textbook_says() -> None:
    time, rate = np.arange(0.0, 20.0, 0.1), 0.1
    level = np.zeros_like(time)
    speed = np.full_like(time, 200.0)
    heading = (rate * time + math.pi) % (2 * math.pi) - math.pi  # wraps
    turning = BodyTrack(np.zeros((len(time), 3)), heading, level, level, speed)
    expected = math.hypot(1.0, 200.0 * rate / GRAVITY_M_S2)
    assert load_factor(turning, time) == pytest.approx(expected, rel=1e-6)
    assert load_factor(sample_flight().evader, sample_flight().time_s) == pytest.approx(1.0)


def test_energy_is_height_and_speed_and_its_colour_goes_with_it() -> None:
    track = sample_flight().missiles[0]
    height = energy_height_m(track)
    assert np.nanmax(height) == pytest.approx(7000.0 + 800.0**2 / (2 * GRAVITY_M_S2))
    assert np.nanmax(energy_share(track)) == 1.0
    for look in (DARK, LIGHT):
        contrast = [
            np.abs(colour.astype(int) - look.background).sum() for colour in energy_colours(np.linspace(0, 1, 5), look)
        ]
        assert contrast == sorted(contrast)


def test_actions_are_held_for_their_step_and_transfer_is_shaded_where_it_was_prevented() -> None:
    flight = replace(sample_flight(), action_rad=np.radians(np.arange(200.0)) / 4)
    columns = action_columns(flight)
    assert list(columns["time_s"][:4]) == [0.0, 1.0, 1.0, 2.0]
    assert list(columns["action_deg"][2:6]) == pytest.approx([0.25, 0.25, 0.5, 0.5])
    allowed = np.ones(200, dtype=bool)
    allowed[[5, 6, 199]] = False
    bands = prevented_bands(flight, GuideTrace("g", (4,), allowed, np.zeros(200)))
    assert list(bands["from_s"]) == [5.0, 199.0]
    assert list(bands["to_s"]) == [7.0, 200.0]
    assert not len(prevented_bands(flight, None)["from_s"])


def test_every_payment_but_that_of_time_is_marked_where_the_return_is() -> None:
    paid = paid_columns(sample_flight())
    assert paid["paid_text"] == ["+50", "+50", "+50", "+50", "+400"]
    assert paid["paid_total"][-1] == pytest.approx(sample_flight().episode_return)


def test_read_outs_say_what_the_flight_says() -> None:
    flight = sample_flight(outcome=Outcome.SHOT_DOWN)
    series = instrument_series(flight, "A", POLICY_A)
    assert series["speed"][100] == SPEED_M_S
    assert series["guide"] is None
    first, last = series["missiles"][0], series["missiles"][-1]
    assert (first["launch"], first["end"], first["fate"], last["fate"]) == (30.0, 90.0, "evaded", "hit")
    assert first["closest"] == pytest.approx(60.0)
    assert first["miss"] == "1.0 km"
    half = round((60.0 - first["launch"]) / first["every"])
    assert first["range"][half] == pytest.approx(1.0)
    # Unwrapped: it goes on from 180° to 360° instead of jumping to -180°.
    assert first["azimuth"][-1] == pytest.approx(360.0, abs=1.0)


def test_a_second_flight_is_dotted_in_its_own_evaders_colour() -> None:
    both = overlay(speed_chart(range(1, 5)))
    both.show(sample_flight(), sample_flight(masked=frozenset({4})), "both")
    evaders = [r for r in both.first.figure.renderers if r.name == "evader_m_s"]
    assert [r.glyph.line_color for r in evaders] == [POLICY_A, POLICY_B]
    assert [bool(r.glyph.line_dash) for r in evaders] == [False, True]
    entry = both.first.figure.legend[0].items[0]
    assert entry.renderers == evaders
    assert evaders[1].data_source is both.source
