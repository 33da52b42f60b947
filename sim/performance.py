"""What the aircraft and the missile of a scenario can do, measured by flying the kernel: turns, climb, fly-out.

The figures of `docs/fidelity.md` come from here, where they stand beside public ones: is this a fighter, and an AMRAAM?
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.scenario import Scenario
from sim.start import initial_states
from sim.task import Task
from sim.trajectory import MissileTrack, fly
from sim.world import World

GRAVITY_M_S2 = 9.80665
SUBSTEP_S = 0.05
SPEED_KEPT_M_S = 0.05
"""A turn is sustained when a minute of it costs less speed than this."""
ENTRY_SUBSTEPS = 40
"""Rolling into a turn takes about a second; within two no speed to speak of is lost."""
HALF_TURN = math.pi / 2
APART_M = 200e3
"""How far from the origin bodies start that must not disturb one another."""
MISSILE_AGES_S = (30, 60)


@dataclass(frozen=True)
class TurnRates:
    """How fast the evader turns in level flight at one altitude and speed."""

    altitude_m: float
    speed_m_s: float
    sustained_rad_s: float
    """Fastest turn that costs neither speed nor altitude."""
    instantaneous_rad_s: float
    """Fastest turn at all, with whatever speed it costs."""

    @property
    def sustained_g(self) -> float:
        """Load factor of the sustained turn."""
        return math.hypot(1.0, self.sustained_rad_s * self.speed_m_s / GRAVITY_M_S2)


@dataclass(frozen=True)
class FlyOut:
    """How far and how fast a missile flies that is fired level at a target far ahead."""

    altitude_m: float
    launch_speed_m_s: float
    peak_speed_m_s: float
    speed_m_s: tuple[float, ...]
    """At `MISSILE_AGES_S`."""
    range_m: tuple[float, ...]
    """From where it was fired, at `MISSILE_AGES_S`."""
    supersonic_range_m: float
    """Distance flown when it falls below Mach 1; NaN while it never does."""


def sound_speed_m_s(altitude_m: float) -> float:
    """Speed of sound of the ISA up to 20 km [m/s]."""
    return math.sqrt(1.4 * 287.05287 * (288.15 - 0.0065 * min(altitude_m, 11e3)))


def turn_rates(scenario: Scenario, altitude_m: float, speed_m_s: float, loads: int = 256) -> TurnRates:
    """Turns of the evader from level flight at an altitude [m] and a speed [m/s].

    One lane per load factor holds its turn for a minute, the command renewed every substep; the fastest lane that keeps
    its speed is the sustained turn. One more lane is commanded a quarter turn at once: the instantaneous rate is the
    fastest of its first seconds, before speed is lost (a slower aircraft may turn faster still).
    """
    task = _alone(scenario, step_s=SUBSTEP_S, substeps=1, max_steps=1300)
    lateral = np.sqrt(np.linspace(1.0, scenario.evader.load_factor_max, loads) ** 2 - 1.0) * GRAVITY_M_S2
    turns = np.append(lateral / (speed_m_s * scenario.evader.heading_gain_1_s), HALF_TURN)
    world = _in_flight(task, np.full(loads + 1, altitude_m), speed_m_s)
    headings = np.unwrap([world.step(turns).observation[:, 2] for _ in range(1200)], axis=0).astype(float)
    world.trace()
    world.step(turns)
    speed = np.array([world.traced(lane)[-1, 3] for lane in range(loads)])
    mean_rate = (headings[-1, :loads] - headings[-400, :loads]) / (399 * SUBSTEP_S)
    fastest = np.diff(headings[:ENTRY_SUBSTEPS, loads]).max() / SUBSTEP_S
    return TurnRates(altitude_m, speed_m_s, float(mean_rate[speed > speed_m_s - SPEED_KEPT_M_S].max()), float(fastest))


def excess_power(scenario: Scenario, altitude_m: float, speeds_m_s: ArrayLike) -> NDArray[np.float64]:
    """Specific excess power (T - D) V / W of the evader at 1 g and full thrust [m/s]: its rate of climb at each speed.

    Flown as in a flight test: a level acceleration from a slow start through all of `speeds_m_s`. To become slow, the
    aircraft turns first, with the limits of load and lift lifted; they play no part in the straight run that counts.
    """
    wanted = np.asarray(speeds_m_s, dtype=float)
    free = dataclasses.replace(scenario.evader, load_factor_max=15.0, cl_max=3.0)
    task = _alone(dataclasses.replace(scenario, evader=free), step_s=1.0, substeps=20, max_steps=400)
    # The controller asks for less than full thrust in the last metres per second before its speed: go beyond.
    reserve = scenario.evader.thrust_max_n / (0.2 * scenario.evader.mass_kg)
    world = _in_flight(task, np.array([altitude_m]), float(wanted.max()) + reserve + 20.0)
    world.trace()
    speed: list[float] = []
    while len(speed) < 30 or (speed[-1] < wanted.max() + 10.0 and len(speed) < 390):
        world.step([HALF_TURN if len(speed) < 30 else 0.0])
        speed.append(float(world.traced(0)[-1, 3]))
    run = np.array(speed[int(np.argmin(speed)) + 3 :])
    return np.interp(wanted, run, run * np.gradient(run) / GRAVITY_M_S2)


def fly_out(scenario: Scenario, altitude_m: float, launch_speed_m_s: float = 300.0) -> FlyOut:
    """Fly-out of the scenario's missile at an altitude [m], fired level from a launch speed [m/s]."""
    missile, flown_s = _lone_shot(scenario, altitude_m, launch_speed_m_s)
    distance = np.linalg.norm(missile.position_m - missile.position_m[0], axis=1)
    speed = missile.speed_m_s
    slow = np.flatnonzero((speed < sound_speed_m_s(altitude_m)) & (flown_s > scenario.missile.burn_s))
    return FlyOut(
        altitude_m,
        launch_speed_m_s,
        peak_speed_m_s=float(speed.max()),
        speed_m_s=tuple(float(np.interp(age, flown_s, speed)) for age in MISSILE_AGES_S),
        range_m=tuple(float(np.interp(age, flown_s, distance)) for age in MISSILE_AGES_S),
        supersonic_range_m=float(distance[slow[0]]) if len(slow) else math.nan,
    )


def aircraft_figures(
    scenario: Scenario, altitudes_m: Sequence[float] = (0.0, 5000.0, 8800.0), mach: float = 0.85
) -> list[tuple[str, str]]:
    """Name and value, with units, of the evader's turn rates and excess power: rows of the page's table."""
    rows: dict[str, list[tuple[str, str]]] = {"sustained": [], "instantaneous": [], "power": []}
    for altitude in altitudes_m:
        speed = mach * sound_speed_m_s(altitude)
        turns, power = turn_rates(scenario, altitude, speed), excess_power(scenario, altitude, [speed])[0]
        at = f"Mach {mach:.2f} at {altitude:.0f} m"
        sustained = f"{math.degrees(turns.sustained_rad_s):.1f} deg/s at {turns.sustained_g:.1f} g"
        rows["sustained"].append((f"sustained turn, {at}", sustained))
        rows["instantaneous"].append(
            (f"instantaneous turn, {at}", f"{math.degrees(turns.instantaneous_rad_s):.1f} deg/s")
        )
        rows["power"].append((f"excess power, {at}", f"{power:.0f} m/s"))
    return [row for group in rows.values() for row in group]


def missile_figures(
    scenario: Scenario, altitudes_m: Sequence[float] = (6000.0, 10000.0), name: str = "default scenario"
) -> list[tuple[str, ...]]:
    """Name, altitude, peak speed, speeds and ranges at `MISSILE_AGES_S`, range above Mach 1: rows of the table."""
    rows: list[tuple[str, ...]] = []
    for altitude in altitudes_m:
        shot = fly_out(scenario, altitude)
        speeds = [f"{speed:.0f} m/s" for speed in (shot.peak_speed_m_s, *shot.speed_m_s)]
        ranges = [f"{metres / 1e3:.1f} km" if metres == metres else "further" for metres in
                  (*shot.range_m, shot.supersonic_range_m)]  # fmt: skip
        rows.append((name, f"{altitude / 1e3:.0f} km", *speeds, *ranges))
    return rows


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """Rows of a Markdown table, without its head."""
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _alone(scenario: Scenario, step_s: float, substeps: int, max_steps: int) -> Task:
    # Nobody fires and nothing ends: only the aircraft flies.
    rules = dataclasses.replace(
        scenario.rules, step_s=step_s, substeps=substeps, max_steps=max_steps, outside_steps=max_steps
    )
    return Task(dataclasses.replace(scenario, rules=rules), frozenset(range(1, scenario.launch.missiles + 1)))


def _in_flight(task: Task, altitudes_m: NDArray, speed_m_s: float) -> World:
    """A world `[L]` with the evader at the origin, heading along x at altitudes `[L]` [m] and a speed [m/s]."""
    world = World(task, len(altitudes_m))
    rows = initial_states(task.scenario, 0, np.arange(len(altitudes_m)))
    rows[:, :10] = (0.0, 0.0, 0.0, 0.0, speed_m_s, APART_M, APART_M, 0.0, 0.0, speed_m_s)
    rows[:, [2, 7]] = altitudes_m[:, None]
    world.reset(states=rows)
    return world


def _lone_shot(scenario: Scenario, altitude_m: float, speed_m_s: float) -> tuple[MissileTrack, NDArray[np.float64]]:
    """Missile 1 fired at once at a target far ahead that meets it level, and its age [s] at every record."""
    start = dataclasses.replace(
        scenario.start,
        evader_x_low_m=-APART_M, evader_x_high_m=-APART_M, interceptor_x_low_m=APART_M, interceptor_x_high_m=APART_M,
        y_spread_m=0.0, heading_spread_rad=0.0, altitude_m=altitude_m, altitude_spread_m=0.0,
        interceptor_speed_m_s=speed_m_s, speed_spread_m_s=0.0,
    )  # fmt: skip
    launch = dataclasses.replace(scenario.launch, range_m=1e6, radar_range_m=1e6, spread=0.0)
    # Without lag it leaves level; with it, it would sink for a while, and a far target would not call it back.
    missile = dataclasses.replace(scenario.missile, speed_min_m_s=50.0, age_max_s=600.0, lag_s=0.01)
    rules = dataclasses.replace(scenario.rules, max_steps=180, outside_steps=180)
    ground = dataclasses.replace(scenario, start=start, launch=launch, missile=missile, rules=rules)
    task = Task(ground, frozenset(range(2, scenario.launch.missiles + 1)))
    flight = fly(task, lambda observation: np.zeros((len(observation), 1)), "straight", seed=0)
    flying = np.isfinite(flight.missiles[0].speed_m_s)
    arrays = {name: getattr(flight.missiles[0], name)[flying] for name in ("position_m", "speed_m_s")}
    age_s = flight.time_s[flying] - flight.missiles[0].launch_s
    return dataclasses.replace(flight.missiles[0], **arrays), age_s
