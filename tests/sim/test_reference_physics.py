"""The reference's physics against closed forms and tables, so that the yardstick itself is measured."""

from __future__ import annotations

import numpy as np
import pytest

from sim.reference_physics import (
    DRAG_MACH,
    AircraftState,
    MissileState,
    air,
    bearing,
    closest_approach,
    flight_velocity,
    fly_aircraft,
    fly_missile,
    length,
    navigate,
    put,
    take,
    wrap,
)
from tests.engagements import DRILL, FIGHTER, changed

DT = 0.05


def _aircraft(speed: float = 280.0, heading: float = 0.0, altitude: float = 8500.0) -> AircraftState:
    one = np.ones(1)
    return AircraftState(np.array([[0.0, 0.0, altitude]]), speed * one, 0.0 * one, heading * one, 0.0 * one)


@pytest.mark.parametrize(
    ("altitude_m", "density", "sound_m_s"),
    [(0.0, 1.225, 340.29), (5000.0, 0.7361, 320.53), (11000.0, 0.3639, 295.07), (15000.0, 0.1937, 295.07)],
)
def test_air_is_that_of_the_standard_tables(altitude_m: float, density: float, sound_m_s: float) -> None:
    found_density, found_sound = air(np.array(altitude_m))
    assert found_density == pytest.approx(density, rel=5e-4)
    assert found_sound == pytest.approx(sound_m_s, rel=1e-4)


def test_angles_wrap_into_the_half_open_turn() -> None:
    np.testing.assert_allclose(wrap([np.pi, -np.pi, 3.0 * np.pi, 0.5, -7.0]), [np.pi, np.pi, np.pi, 0.5, 2 * np.pi - 7])


def test_level_flight_stays_level_and_straight() -> None:
    a = _aircraft()
    for _ in range(200):
        a = fly_aircraft(a, FIGHTER, np.zeros(1), np.array([8500.0]), np.array([280.0]), DT)
    np.testing.assert_allclose(a.position, [[2800.0, 0.0, 8500.0]], atol=1e-6)
    np.testing.assert_allclose(a.speed, [280.0])


def test_a_turn_goes_left_for_positive_angles_and_reaches_its_heading() -> None:
    a = _aircraft()
    for step in range(1200):
        a = fly_aircraft(a, FIGHTER, np.array([1.2]), np.array([8500.0]), np.array([280.0]), DT)
        assert step > 40 or a.bank[0] >= 0.0
    np.testing.assert_allclose(a.heading, [1.2], atol=1e-3)
    assert a.position[0, 1] > 0.0


def test_a_coasting_missile_without_air_keeps_its_energy() -> None:
    thin = changed(DRILL, missile={"thrust_n": 0.0, "navigation_constant": 1.0, "cd0": 0.001, "induced_drag": 0.0})
    start = np.array([[0.0, 0.0, 18e3]])
    m = MissileState(start, np.array([[600.0, 0.0, 100.0]]), np.zeros((1, 3)), np.zeros(1))
    before = 0.5 * length(m.velocity) ** 2 + 9.80665 * m.position[:, 2]
    for _ in range(200):
        m = fly_missile(m, thin.missile, np.array([[50e3, 0.0, 18e3]]), np.zeros((1, 3)), DT)
    after = 0.5 * length(m.velocity) ** 2 + 9.80665 * m.position[:, 2]
    np.testing.assert_allclose(after, before, rtol=5e-3)
    assert m.age[0] == 10.0


def test_the_motor_gives_its_impulse_whatever_the_substep() -> None:
    gained = []
    for dt in (0.05, 0.07):
        m = MissileState(np.array([[0.0, 0.0, 15e3]]), np.array([[300.0, 0.0, 0.0]]), np.zeros((1, 3)), np.zeros(1))
        while m.age[0] < 8.4:
            m = fly_missile(m, DRILL.missile, np.array([[90e3, 0.0, 15e3]]), np.zeros((1, 3)), dt)
        gained.append(length(m.velocity)[0])
    assert gained[0] == pytest.approx(gained[1], rel=5e-3)


def test_navigation_turns_after_the_line_of_sight_and_ignores_a_target_that_opens() -> None:
    offset, closing = np.array([[1000.0, 0.0, 0.0]]), np.array([[-300.0, 20.0, 0.0]])
    np.testing.assert_allclose(navigate(offset, closing, 4.0), [[0.0, 4.0 * 300.0 * 20.0 / 1000.0, 0.0]])
    np.testing.assert_array_equal(navigate(offset, -closing, 4.0), np.zeros((1, 3)))


def test_closest_approach_lies_within_the_move() -> None:
    before, after = np.array([[-10.0, 3.0, 4.0], [5.0, 0.0, 0.0]]), np.array([[10.0, 3.0, 4.0], [9.0, 0.0, 0.0]])
    np.testing.assert_allclose(closest_approach(before, after), [5.0, 5.0])


def test_bodies_are_taken_and_put_back() -> None:
    a = _aircraft(heading=0.3)
    copy = take(a, np.array([0]))
    copy.heading += 1.0
    assert a.heading[0] == 0.3
    put(a, np.array([0]), copy)
    assert a.heading[0] == 1.3
    np.testing.assert_allclose(bearing(flight_velocity(a)), [1.3])
    assert np.all(np.diff(DRAG_MACH) > 0.0)
