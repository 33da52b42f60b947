"""What the kernel does each substep, checked against records of flights and plain formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.geometry import azimuth, wrap_to_pi
from sim.scenario import Scenario
from sim.start import initial_states
from sim.trajectory import Trajectory, fly
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, changed, circle, drag, fly_lanes, straight, task, to_exit

EPISODES = range(6)
DT = DRILL.rules.step_s / DRILL.rules.substeps
CENTRED = {"y_spread_m": 0.0, "heading_spread_rad": 0.0}
NOBODY = (1, 2, 3, 4)


def zone(trajectory: Trajectory, scenario: Scenario, at: int, factor: float) -> bool:
    """Whether the interceptor may fire at a recorded time, from the words of the scenario."""
    e, i = trajectory.evader, trajectory.interceptor
    offset = e.position_m[at] - i.position_m[at]
    distance = float(np.linalg.norm(offset))
    off_nose = abs(float(azimuth(i.position_m[at, :2], i.heading_rad[at], e.position_m[at, :2])))
    nose = [
        math.cos(e.pitch_rad[at]) * math.cos(e.heading_rad[at]),
        math.cos(e.pitch_rad[at]) * math.sin(e.heading_rad[at]),
        math.sin(e.pitch_rad[at]),
    ]
    head_on = -float(np.dot(nose, offset)) / distance  # 1 nose to nose, -1 chased
    aspect = np.interp(head_on, [-1.0, 1.0], [scenario.launch.tail_fraction, 1.0])
    reach = scenario.launch.range_m * factor * float(aspect)
    in_radar = distance <= scenario.launch.radar_range_m and off_nose <= scenario.launch.radar_half_angle_rad
    return in_radar and scenario.launch.range_min_m <= distance <= reach


@pytest.mark.parametrize("act", [straight, drag, circle])
def test_the_first_missile_is_fired_as_soon_as_the_zone_allows(act: object) -> None:
    for episode in EPISODES:
        trajectory = fly(task(), act, "test", seed=1, episode=episode)
        factor = initial_states(DRILL, 1, np.array([episode]))[0, 10]
        fired = round(trajectory.missiles[0].launch_s / DT)
        assert zone(trajectory, DRILL, fired, factor)
        if fired > 1:
            assert not any(zone(trajectory, DRILL, at, factor) for at in range(1, fired))


def test_launches_keep_the_interval() -> None:
    launches = [m.launch_s for e in EPISODES for m in fly(task(), drag, "test", 1, e).missiles]
    gaps = np.diff(np.reshape(launches, (-1, 4)), axis=1)
    gaps = gaps[np.isfinite(gaps)]
    assert len(gaps) > 6
    assert (gaps >= DRILL.launch.interval_s - 1e-6).all()
    # When the evader stays in the zone, the next one follows at once.
    assert gaps.min() <= DRILL.launch.interval_s + 2 * DT


@pytest.mark.parametrize(
    "launch",
    [{"radar_range_m": 1e3}, {"range_m": 1e3}, {"range_min_m": 99e3}],
    ids=["radar too short", "missiles too short", "always too close"],
)
def test_outside_the_zone_nothing_is_fired(launch: dict[str, float]) -> None:
    flights = fly_lanes(World(task(scenario=changed(launch=launch)), 8), to_exit)
    assert (flights.fates == Fate.UNLAUNCHED).all()
    assert (flights.outcome == Outcome.EXIT).all()


def test_a_chased_evader_is_shot_at_from_nearer_than_one_met_head_on() -> None:
    # No random factor: head-on the reach is the range, in a tail chase three quarters of it.
    scenario = changed(launch={"spread": 0.0})
    ahead = fly(task(scenario=scenario), straight, "test", 1).missiles[0]
    met_m = ahead.range_m[np.isfinite(ahead.range_m)][0]
    assert 0.9 * 30e3 < met_m <= 30e3
    # The interceptor starts behind an evader that flies away from it.
    behind = changed(
        scenario,
        start=CENTRED | {"interceptor_x_low_m": -60e3, "interceptor_x_high_m": -60e3, "interceptor_speed_m_s": 400.0},
        launch={"radar_half_angle_rad": 3.1},
    )
    chased = fly(task(scenario=behind), straight, "test", 1).missiles[0]
    chased_m = chased.range_m[np.isfinite(chased.range_m)][0]
    assert chased_m == pytest.approx(0.75 * 30e3, rel=0.01)


def test_a_missile_leaves_with_its_carriers_place_and_velocity() -> None:
    trajectory = fly(task(), drag, "test", 1)
    carrier = trajectory.interceptor
    for missile in trajectory.missiles:
        if missile.fate is Fate.UNLAUNCHED:
            continue
        at = round(missile.launch_s / DT)
        np.testing.assert_array_equal(missile.position_m[at], carrier.position_m[at])
        assert missile.speed_m_s[at] == pytest.approx(carrier.speed_m_s[at], rel=1e-6)
        assert float(wrap_to_pi(missile.heading_rad[at] - carrier.heading_rad[at])) == pytest.approx(0.0, abs=1e-6)
        assert missile.pitch_rad[at] == pytest.approx(carrier.pitch_rad[at], abs=1e-6)


def test_a_missile_speeds_up_while_its_motor_burns_and_slows_down_after() -> None:
    missile = next(m for e in EPISODES for m in fly(task(), circle, "test", 2, e).missiles if m.fate is Fate.EVADED)
    speed = missile.speed_m_s[np.isfinite(missile.speed_m_s)]
    burnt = round(DRILL.missile.burn_s / DT)
    assert (np.diff(speed[:burnt]) > 0.0).all()
    assert speed[burnt] > 2.5 * speed[0]
    assert (np.diff(speed[burnt + 1 :]) < 1.0).all()


def test_straight_flight_keeps_heading_altitude_and_speed() -> None:
    body = fly(task(*NOBODY), straight, "test", 3).evader
    assert np.ptp(body.heading_rad) < 1e-5
    assert np.ptp(body.position_m[:, 2]) < 1.0
    assert np.ptp(body.speed_m_s) < 0.5


def test_hard_turns_bleed_speed_and_hold_the_altitude() -> None:
    scenario = changed(rules={"max_steps": 60})
    body = fly(task(*NOBODY, scenario=scenario), circle, "test", 3).evader
    assert body.speed_m_s[-1] < 0.9 * body.speed_m_s[0]
    assert np.ptp(body.position_m[:, 2]) < 400.0


def test_a_commanded_turn_is_flown_to_its_end_and_not_beyond() -> None:
    # A heading command: hold the north once it is reached, from whatever it was.
    def north(observation: NDArray) -> NDArray:
        return wrap_to_pi(np.pi / 2 - observation[:, 2:3])

    scenario = changed(rules={"max_steps": 60})
    heading = fly(task(*NOBODY, scenario=scenario), north, "test", 3).evader.heading_rad
    assert heading[-1] == pytest.approx(np.pi / 2, abs=1e-3)
    assert heading.max() < np.pi / 2 + 0.01


def test_the_interceptor_keeps_pointing_at_the_evader() -> None:
    trajectory = fly(task(*NOBODY), drag, "test", 4)
    i, e = trajectory.interceptor, trajectory.evader
    off_nose = np.abs(azimuth(i.position_m[:, :2], i.heading_rad, e.position_m[:, :2]))
    far = np.linalg.norm(i.position_m - e.position_m, axis=1) > 5e3
    late = trajectory.time_s > 20.0
    assert off_nose[far & late].max() < 0.1


def test_the_exit_is_a_gate_on_the_right_edge() -> None:
    centred = changed(start=CENTRED)
    through = fly(task(*NOBODY, scenario=centred), straight, "test", 1)
    assert through.outcome is Outcome.EXIT
    x = through.evader.position_m[:, 0]
    assert x[-2] < 35e3 <= x[-1]
    assert through.reward_terms[-1, 0] == 400.0


@pytest.mark.parametrize(("gate_y_m", "through"), [(4.9e3, True), (-4.9e3, True), (5.1e3, False), (-5.1e3, False)])
def test_the_gate_is_as_wide_as_the_scenario_says(gate_y_m: float, through: bool) -> None:
    # The evader flies along y = 0; the gate of half width 5 km is moved.
    scenario = changed(start=CENTRED, battlefield={"exit_y_m": gate_y_m})
    outcome = fly(task(*NOBODY, scenario=scenario), straight, "test", 1).outcome
    assert outcome is (Outcome.EXIT if through else Outcome.LEFT_FIELD)


def test_more_than_ten_steps_outside_are_a_loss() -> None:
    scenario = changed(start=CENTRED, battlefield={"exit_y_m": 20e3})
    flights = fly_lanes(World(task(*NOBODY, scenario=scenario), 8), straight)
    for lane in range(8):
        outside = np.abs(flights.observation[1:, lane, 0]) > 35e3
        flown = flights.steps[lane]
        assert outside[:flown].sum() == 11
        assert flights.terminated[flown - 1, lane]
        np.testing.assert_allclose(flights.terms[flown - 1, lane], [-400.0, 0.0, 0.0, 0.0, 0.0, -0.1])
    assert (flights.outcome == Outcome.LEFT_FIELD).all()


def test_coming_back_in_time_is_forgiven() -> None:
    # Over the upper edge at a shallow angle and back again, over and over: many steps outside, never eleven in a row.
    def skim(observation: NDArray) -> NDArray:
        wanted = np.where(observation[:, 1:2] > 25e3, -0.4, 0.3)
        return np.clip(wanted - observation[:, 2:3], -np.pi / 2, np.pi / 2)

    scenario = changed(start=CENTRED, battlefield={"length_m": 400e3}, rules={"max_steps": 700})
    flights = fly_lanes(World(task(*NOBODY, scenario=scenario), 1), skim)
    outside = np.abs(flights.observation[1:, 0, 1]) > 25e3
    assert outside.sum() > 22
    runs = np.diff(np.flatnonzero(np.diff(np.r_[0, outside.astype(int), 0])))[::2]
    assert runs.max() <= 10
    assert flights.outcome[0] == Outcome.TIMEOUT


def test_a_kill_is_within_the_fuse_and_names_its_missile() -> None:
    killed = [t for e in range(12) if (t := fly(task(), to_exit, "test", 5, e)).outcome is Outcome.SHOT_DOWN]
    assert len(killed) > 6
    for trajectory in killed:
        missile = trajectory.missiles[trajectory.killer - 1]
        assert missile.fate is Fate.HIT
        assert missile.closest_m <= DRILL.missile.fuse_m
        assert trajectory.reward_terms[-1, trajectory.killer] == -400.0


def test_a_missile_is_not_armed_at_once() -> None:
    # Fired from beside its target, whose fuse it would trigger: it flies past, still safe.
    scenario = changed(
        start=CENTRED | {"interceptor_x_low_m": -27e3, "interceptor_x_high_m": -27e3, "altitude_spread_m": 0.0},
        launch={"range_min_m": 0.0}, missile={"arm_s": 30.0},
    )  # fmt: skip
    missile = fly(task(2, 3, 4, scenario=scenario), straight, "test", 1).missiles[0]
    assert missile.closest_m < DRILL.missile.fuse_m
    assert missile.fate is Fate.EVADED


@pytest.mark.parametrize(
    ("numbers", "check"),
    [
        ({"age_max_s": 20.0, "speed_min_m_s": 50.0}, "old"),
        ({"speed_min_m_s": 700.0}, "slow"),
        ({"opening_m": 50.0, "lag_s": 5.0, "speed_min_m_s": 50.0}, "opening"),
    ],
)
def test_a_spent_missile_is_evaded(numbers: dict[str, float], check: str) -> None:
    missile = fly(task(2, 3, 4, scenario=changed(missile=numbers)), circle, "test", 5).missiles[0]
    assert missile.fate is Fate.EVADED
    flight = np.flatnonzero(np.isfinite(missile.range_m))
    age, last = (len(flight) - 1) * DT, flight[-1]
    if check == "old":
        assert age == pytest.approx(20.0, abs=2 * DT)
    if check == "slow":
        assert missile.speed_m_s[last] < 700.0 <= missile.speed_m_s[last - 1]
    if check == "opening":
        assert missile.range_m[last] - missile.closest_m > 50.0
        assert missile.range_m[last - 1] - missile.closest_m <= 50.0 + 1.0


def test_the_motor_burns_out_before_slowness_counts() -> None:
    # It leaves slower than its least speed: without the motor's grace it would be evaded at once.
    scenario = changed(missile={"speed_min_m_s": 400.0})
    missile = fly(task(2, 3, 4, scenario=scenario), to_exit, "test", 5).missiles[0]
    assert np.isfinite(missile.range_m).sum() * DT > DRILL.missile.burn_s
