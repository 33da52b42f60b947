"""Aircraft and missiles stay within what their numbers allow, and energy is neither found nor lost."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.trajectory import BodyTrack, MissileTrack, fly
from sim.world import Fate
from tests.engagements import DRILL, FIGHTER, Policy, changed, circle, drag, straight, task

GRAVITY = 9.80665
DT = DRILL.rules.step_s / DRILL.rules.substeps
SHORT = {"max_steps": 120}


def zigzag(observation: NDArray) -> NDArray:
    """Hard over to one side, then to the other, by position."""
    return np.where(np.floor(observation[:, :1] / 1500.0) % 2 == 0, 1.5, -1.5)


def bodies(act: Policy) -> list[BodyTrack]:
    flown = [fly(task(scenario=changed(rules=SHORT)), act, "test", seed=3, episode=e) for e in range(4)]
    return [body for t in flown for body in (t.evader, t.interceptor)]


def density(altitude: NDArray) -> NDArray:
    """ISA air density [kg/m^3] by the hydrostatic equation, in double precision and another way than the kernel."""
    grid = np.linspace(0.0, 25e3, 250_001)
    kelvin = np.maximum(288.15 - 0.0065 * grid, 216.65)
    fall = GRAVITY / (287.05287 * kelvin)
    steps = (fall[1:] + fall[:-1]) / 2 * np.diff(grid)
    pressure = 101325.0 * np.exp(-np.concatenate([[0.0], np.cumsum(steps)]))
    return np.interp(altitude, grid, pressure / (287.05287 * kelvin))


def load_factor(body: BodyTrack) -> NDArray:
    """Load factor [1] from the turn rates of the recorded path."""
    turn = np.unwrap(body.heading_rad)
    middle = slice(0, -1)
    speed, climb = body.speed_m_s[middle], body.pitch_rad[middle]
    sideways = speed * np.cos(climb) * np.diff(turn) / DT / GRAVITY
    upwards = speed * np.diff(body.pitch_rad) / DT / GRAVITY + np.cos(climb)
    return np.hypot(sideways, upwards)


@pytest.mark.parametrize("act", [zigzag, drag, circle])
def test_the_load_factor_stays_below_the_structures_and_the_wings(act: Policy) -> None:
    highest = 0.0
    for body in bodies(act):
        load = load_factor(body)
        lift = 0.5 * density(body.position_m[:-1, 2]) * body.speed_m_s[:-1] ** 2 * FIGHTER.wing_area_m2 * FIGHTER.cl_max
        limit = np.minimum(FIGHTER.load_factor_max, lift / (FIGHTER.mass_kg * GRAVITY))
        # float32 headings resolve 2e-7 rad, over a substep and at 280 m/s about 1e-4 of a load factor.
        assert (load <= limit * 1.002 + 2e-3).all()
        highest = max(highest, load.max())
    assert highest > 2.0


@pytest.mark.parametrize("act", [zigzag, drag, circle])
def test_the_bank_stays_below_a_quarter_turn_and_rolls_no_faster_than_allowed(act: Policy) -> None:
    for body in bodies(act):
        assert abs(body.bank_rad).max() < np.pi / 2
        assert abs(np.diff(body.bank_rad)).max() <= FIGHTER.roll_rate_max_rad_s * DT * (1 + 1e-5)
        # A coordinated turn of at most the structure's load factor needs no more bank than this.
        assert abs(body.bank_rad).max() <= np.arccos(0.2 / FIGHTER.load_factor_max) + 1e-6


def test_a_turn_bends_the_way_it_banks() -> None:
    for body in bodies(zigzag):
        turning = np.abs(body.bank_rad[1:]) > 0.1
        bent = np.diff(np.unwrap(body.heading_rad))
        assert (np.sign(bent[turning]) == np.sign(body.bank_rad[1:][turning])).all()


def test_thrust_never_exceeds_the_engine() -> None:
    for body in bodies(zigzag):
        height, speed, load = body.position_m[:, 2], body.speed_m_s, load_factor(body)
        energy_rate = FIGHTER.mass_kg * np.diff(speed**2 / 2 + GRAVITY * height) / DT
        air = density(height[:-1])
        pressure = 0.5 * air * speed[:-1] ** 2 * FIGHTER.wing_area_m2
        weight = FIGHTER.mass_kg * GRAVITY
        drag_n = pressure * FIGHTER.cd0 + FIGHTER.induced_drag * (load * weight) ** 2 / pressure
        thrust_n = energy_rate / speed[:-1] + drag_n
        engine_n = FIGHTER.thrust_max_n * (air / 1.225) ** 0.7
        # Averages over a second: single differences of float32 heights are noisy.
        smooth = np.convolve(thrust_n - engine_n, np.full(20, 0.05), "valid")
        assert smooth.max() < 0.01 * FIGHTER.thrust_max_n
        assert np.convolve(thrust_n, np.full(20, 0.05), "valid").min() > -0.01 * FIGHTER.thrust_max_n


@pytest.mark.parametrize("act", [straight, circle])
def test_a_glider_loses_the_energy_that_drag_takes(act: Policy) -> None:
    engineless = {"thrust_max_n": 100.0, "mass_kg": 12000.0}
    scenario = changed(evader=engineless, interceptor=engineless, rules={"max_steps": 40})
    for episode in range(3):
        body = fly(task(1, 2, 3, 4, scenario=scenario), act, "glide", seed=3, episode=episode).evader
        height, speed, load = body.position_m[:, 2], body.speed_m_s, load_factor(body)
        energy = 12000.0 * (speed**2 / 2 + GRAVITY * height)
        pressure = 0.5 * density(height[:-1]) * speed[:-1] ** 2 * FIGHTER.wing_area_m2
        drag_n = pressure * FIGHTER.cd0 + FIGHTER.induced_drag * (load * 12000.0 * GRAVITY) ** 2 / pressure
        work = (drag_n * speed[:-1] * DT).sum()
        assert energy[0] - energy[-1] == pytest.approx(work, rel=0.01)


def shots(**missile: float) -> list[MissileTrack]:
    scenario = changed(missile=missile)
    flown = [fly(task(2, 3, 4, scenario=scenario), circle, "test", seed=5, episode=e).missiles[0] for e in range(4)]
    return [m for m in flown if m.fate is not Fate.UNLAUNCHED]


def velocity(missile: MissileTrack) -> tuple[NDArray, NDArray]:
    """Position and velocity `[n, 3]` while the missile flies."""
    flying = np.isfinite(missile.range_m)
    pitch, heading, speed = missile.pitch_rad[flying], missile.heading_rad[flying], missile.speed_m_s[flying]
    nose = np.stack([np.cos(pitch) * np.cos(heading), np.cos(pitch) * np.sin(heading), np.sin(pitch)], axis=1)
    return missile.position_m[flying], speed[:, None] * nose


def test_missiles_pull_no_more_than_they_may() -> None:
    for missile in shots():
        position, speed = velocity(missile)
        acceleration = np.diff(speed, axis=0) / DT + [0.0, 0.0, GRAVITY]
        nose = speed[:-1] / np.linalg.norm(speed[:-1], axis=1, keepdims=True)
        lateral = np.linalg.norm(acceleration - (acceleration * nose).sum(axis=1, keepdims=True) * nose, axis=1)
        pressure = 0.5 * density(position[:-1, 2]) * (speed[:-1] ** 2).sum(axis=1)
        share = np.minimum(1.0, pressure / DRILL.missile.full_load_pressure_pa)
        # The autopilot lags behind a falling limit by its time constant.
        behind = np.maximum.accumulate(share[::-1])[::-1] if share[-1] > share[0] else np.maximum.accumulate(share)
        assert (lateral <= DRILL.missile.load_factor_max * GRAVITY * behind * 1.01 + 1.0).all()


def test_a_coasting_missile_loses_the_energy_that_drag_takes() -> None:
    # Drag again from the scenario's words: zero-lift drag by Mach number plus drag due to the lateral pull.
    table_mach = [0.0, 0.6, 1.0, 1.2, 2.0, 3.0, 4.0, 9.0]
    table_share = [0.532, 0.532, 0.853, 1.0, 0.819, 0.630, 0.504, 0.504]
    mass = DRILL.missile.mass_kg - DRILL.missile.propellant_kg
    checked = 0
    for missile in shots(speed_min_m_s=350.0):
        position, speed = velocity(missile)
        coast = slice(round(DRILL.missile.burn_s / DT) + 2, -1)
        position, speed = position[coast], speed[coast]
        if len(speed) < 100:
            continue
        v = np.linalg.norm(speed, axis=1)[:-1]
        acceleration = np.diff(speed, axis=0) / DT + [0.0, 0.0, GRAVITY]
        nose = speed[:-1] / v[:, None]
        lateral = np.linalg.norm(acceleration - (acceleration * nose).sum(axis=1, keepdims=True) * nose, axis=1)
        height = position[:-1, 2]
        sound = np.sqrt(1.4 * 287.05287 * np.maximum(288.15 - 0.0065 * height, 216.65))
        force = 0.5 * density(height) * v**2 * DRILL.missile.area_m2
        drag_n = force * DRILL.missile.cd0 * np.interp(v / sound, table_mach, table_share)
        drag_n += DRILL.missile.induced_drag * (mass * lateral) ** 2 / force
        middle = (speed[:-1] + speed[1:]) / 2
        work = (drag_n * (middle * nose).sum(axis=1) * DT).sum()
        energy = mass * ((speed**2).sum(axis=1) / 2 + GRAVITY * position[:, 2])
        assert energy[0] - energy[-1] == pytest.approx(work, rel=0.005)
        checked += 1
    assert checked >= 2
