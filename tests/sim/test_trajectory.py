"""Recorded engagements: what they hold, in which order, and that they agree with flights nobody recorded."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.geometry import azimuth
from sim.scenario import Scenario
from sim.trajectory import BodyTrack, Trajectory, fly
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, changed, circle, close, drag, fly_lanes, straight, task, to_exit, wrapped

DT = DRILL.rules.step_s / DRILL.rules.substeps
FLIGHTS = [fly(task(*masked), act, act.__name__, seed=5, episode=e)
           for act in (drag, straight, circle) for e in range(4) for masked in ((), (2,))]  # fmt: skip


def leaving() -> Trajectory:
    scenario: Scenario = changed(battlefield={"exit_y_m": 22e3, "exit_half_width_m": 500.0})
    return fly(task(1, 2, 3, 4, scenario=scenario), straight, "straight", seed=1)


def waiting() -> Trajectory:
    return fly(task(1, 2, 3, 4, scenario=changed(rules={"max_steps": 40})), circle, "circle", seed=1)


def test_the_flights_below_end_in_more_than_one_way() -> None:
    assert {t.outcome for t in FLIGHTS} >= {Outcome.EXIT, Outcome.SHOT_DOWN}
    assert {m.fate for t in FLIGHTS for m in t.missiles} == set(Fate)


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_arrays_have_one_entry_per_recorded_time_or_per_step(trajectory: Trajectory) -> None:
    times, steps = len(trajectory.time_s), len(trajectory.step_time_s)
    for body in (trajectory.evader, trajectory.interceptor):
        assert body.position_m.shape == (times, 3)
        assert {len(getattr(body, f.name)) for f in dataclasses.fields(BodyTrack)} == {times}
    for missile in trajectory.missiles:
        assert missile.position_m.shape == (times, 3)
        assert len(missile.azimuth_rad) == len(missile.pitch_rad) == times
    assert trajectory.observation.shape == (steps, trajectory.task.layout.size)
    assert trajectory.reward_terms.shape == (steps, 6)
    assert trajectory.action_rad.shape == (steps,)


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_time_starts_at_zero_and_goes_by_substeps(trajectory: Trajectory) -> None:
    assert trajectory.time_s[0] == 0.0
    np.testing.assert_allclose(np.diff(trajectory.time_s), DT)
    assert trajectory.duration_s == trajectory.time_s[-1]
    # The last step ends early when something happened within it.
    assert len(trajectory.step_time_s) - 1 < trajectory.duration_s <= len(trajectory.step_time_s)


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_observations_are_of_the_recorded_instants(trajectory: Trajectory) -> None:
    at = np.round(trajectory.step_time_s / DT).astype(int)
    e, i, o = trajectory.evader, trajectory.interceptor, trajectory.observation
    np.testing.assert_array_equal(o[:, :2], e.position_m[at, :2])
    np.testing.assert_array_equal(o[:, 2], e.heading_rad[at])
    np.testing.assert_allclose(o[:, 3], np.linalg.norm(i.position_m[at] - e.position_m[at], axis=1), rtol=1e-6)
    for missile in trajectory.missiles:
        r, phi = o[:, trajectory.task.layout.block(missile.number)].T
        seen = r >= 0.0
        np.testing.assert_allclose(r[seen], missile.range_m[at][seen], rtol=1e-5, atol=0.02)
        turned = wrapped(phi[seen] - missile.azimuth_rad[at][seen])
        np.testing.assert_allclose(turned, 0.0, atol=1e-3)
        assert not np.isfinite(missile.range_m[at][~seen]).any() or missile.fate is not Fate.UNLAUNCHED


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_missiles_are_nan_exactly_outside_their_flight(trajectory: Trajectory) -> None:
    for missile in trajectory.missiles:
        if missile.fate is Fate.UNLAUNCHED:
            assert np.isnan(missile.position_m).all()
            assert np.isnan([missile.launch_s, missile.end_s, missile.closest_m]).all()
            continue
        until = trajectory.duration_s if missile.fate is Fate.FLYING else missile.end_s
        inside = (trajectory.time_s >= missile.launch_s - 1e-9) & (trajectory.time_s <= until + 1e-9)
        for values in (missile.range_m, missile.speed_m_s, missile.heading_rad, missile.pitch_rad, missile.azimuth_rad):
            np.testing.assert_array_equal(np.isfinite(values), inside)


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_ranges_and_azimuths_are_those_of_the_positions(trajectory: Trajectory) -> None:
    e = trajectory.evader
    for missile in trajectory.missiles:
        flying = np.isfinite(missile.range_m)
        offset = missile.position_m[flying] - e.position_m[flying]
        np.testing.assert_allclose(missile.range_m[flying], np.linalg.norm(offset, axis=1))
        seen = azimuth(e.position_m[flying, :2], e.heading_rad[flying], missile.position_m[flying, :2])
        np.testing.assert_allclose(missile.azimuth_rad[flying], seen)
        if missile.fate in (Fate.EVADED, Fate.HIT):
            # The record's smallest distance can only be larger: the closest approach lies between two records.
            assert missile.closest_m <= missile.range_m[flying].min() + 0.05


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_speeds_are_those_of_the_path(trajectory: Trajectory) -> None:
    for body in (trajectory.evader, trajectory.interceptor):
        moved = np.linalg.norm(np.diff(body.position_m, axis=0), axis=1) / DT
        # float32 positions resolve some millimetres, which over a substep is a few tenths of a metre per second.
        np.testing.assert_allclose(moved, (body.speed_m_s[1:] + body.speed_m_s[:-1]) / 2, atol=0.5)


@pytest.mark.parametrize("trajectory", [*FLIGHTS, leaving(), waiting()])
def test_events_are_in_order_and_inside_the_flight(trajectory: Trajectory) -> None:
    times = [event.time_s for event in trajectory.events]
    assert times == sorted(times)
    assert all(0.0 <= time <= trajectory.duration_s for time in times)


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_every_missile_tells_its_story_once_and_in_order(trajectory: Trajectory) -> None:
    stories = {
        Fate.UNLAUNCHED: [],
        Fate.FLYING: ["launch"],
        Fate.EVADED: ["launch", "closest", "evaded"],
        Fate.HIT: ["launch", "shot_down"],
    }
    for missile in trajectory.missiles:
        mine = [event for event in trajectory.events if event.missile == missile.number]
        assert [event.kind for event in mine] == stories[missile.fate]
        if mine:
            assert mine[0].time_s == missile.launch_s
        if mine[1:]:
            assert mine[-1].time_s == missile.end_s
            assert mine[1].distance_m == missile.closest_m


@pytest.mark.parametrize(
    ("trajectory", "kind"),
    [
        (next(t for t in FLIGHTS if t.outcome is Outcome.EXIT), "exit"),
        (next(t for t in FLIGHTS if t.outcome is Outcome.SHOT_DOWN), "shot_down"),
        (leaving(), "left_field"),
        (waiting(), "timeout"),
    ],
)
def test_the_last_event_is_how_it_ended(trajectory: Trajectory, kind: str) -> None:
    assert trajectory.events[-1].kind == kind
    assert trajectory.events[-1].time_s == trajectory.duration_s
    assert trajectory.success == (kind == "exit")


@pytest.mark.parametrize("trajectory", FLIGHTS)
def test_rewards_fall_when_their_events_happen(trajectory: Trajectory) -> None:
    expected = np.zeros_like(trajectory.reward_terms)
    expected[:, -1] = -0.1
    worth = {"evaded": 50.0, "shot_down": -400.0, "exit": 400.0}
    for event in trajectory.events:
        if event.kind in worth:
            step = int(np.ceil(event.time_s / DRILL.rules.step_s - 1e-9)) - 1
            expected[step, event.missile] += worth[event.kind]
    np.testing.assert_allclose(trajectory.reward_terms, expected, atol=1e-6)


def test_event_texts_name_missile_and_distance() -> None:
    trajectory = next(t for t in FLIGHTS if t.missiles[0].fate is Fate.EVADED)
    launch, closest, evaded = (event for event in trajectory.events if event.missile == 1)
    assert launch.text == f"missile 1 launched at {launch.distance_m / 1e3:.1f} km"
    assert closest.text.startswith("missile 1 closest, ")
    assert evaded.text == "missile 1 evaded"


@pytest.mark.parametrize("every", [2, 7, 20, 10**6])
def test_thinning_keeps_every_nth_time_and_the_last(every: int) -> None:
    full = FLIGHTS[0]
    thin = full.thin(every)
    np.testing.assert_array_equal(thin.time_s[:-1], full.time_s[:-1:every])
    assert thin.time_s[-1] == full.time_s[-1]
    np.testing.assert_array_equal(thin.evader.position_m[-1], full.evader.position_m[-1])
    np.testing.assert_array_equal(thin.missiles[0].range_m[:-1], full.missiles[0].range_m[:-1:every])


def test_thinning_keeps_steps_events_and_outcome() -> None:
    full = FLIGHTS[0]
    thin = full.thin(20)
    assert (thin.events, thin.outcome, thin.killer) == (full.events, full.outcome, full.killer)
    assert thin.reward_terms is full.reward_terms
    assert thin.missiles[0].closest_m == full.missiles[0].closest_m


def test_recording_every_nth_substep_is_thinning() -> None:
    thin = fly(task(), drag, "drag", seed=5, record_every=20)
    np.testing.assert_array_equal(thin.time_s, FLIGHTS[0].thin(20).time_s)


@pytest.mark.parametrize("act", [drag, straight, to_exit])
def test_a_recorded_episode_is_the_lane_of_the_same_number(act: object) -> None:
    lanes = fly_lanes(World(task(3), 8, seed=21), act)
    for episode in range(8):
        trajectory = fly(task(3), act, "test", seed=21, episode=episode)
        steps = lanes.steps[episode]
        assert len(trajectory.action_rad) == steps
        np.testing.assert_array_equal(trajectory.observation, lanes.observation[:steps, episode])
        np.testing.assert_allclose(trajectory.reward_terms, lanes.terms[:steps, episode], atol=1e-6)
        assert close(trajectory.episode_return, float(lanes.terms[:, episode].sum(dtype=np.float64)))
        assert trajectory.outcome == lanes.outcome[episode]
        assert trajectory.killer == lanes.killer[episode]


def test_every_masked_missile_is_left_out() -> None:
    assert [m.number for m in fly(task(2, 4), drag, "test", seed=1).missiles] == [1, 3]


def test_captions_are_kept() -> None:
    trajectory = fly(task(), drag, "a policy", seed=3, episode=9)
    assert (trajectory.policy, trajectory.seed, trajectory.episode) == ("a policy", 3, 9)
