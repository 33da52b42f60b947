"""Engagements for tests: a small scenario with fixed numbers, scripted policies, and ways to fly them.

`DRILL` is written out here, so that recalibrating the shipped scenario never moves a test. It is over in a few minutes
of flight: missiles fly after some seconds, and random, straight and dragging flights end in every way there is.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.scenario import Aircraft, Battlefield, Launch, Missile, Reward, Rules, Scenario, Start
from sim.task import Task
from sim.world import Fate, Outcome, Step, World

FIGHTER = Aircraft(
    mass_kg=12000.0,
    wing_area_m2=27.87,
    cd0=0.02,
    induced_drag=0.12,
    cl_max=1.2,
    load_factor_max=6.0,
    roll_rate_max_rad_s=1.6,
    thrust_max_n=110e3,
    heading_gain_1_s=0.8,
)

DRILL = Scenario(
    name="drill",
    description="small and quick, for tests",
    battlefield=Battlefield(length_m=70e3, width_m=50e3, exit_y_m=0.0, exit_half_width_m=5e3),
    evader=FIGHTER,
    interceptor=FIGHTER,
    launch=Launch(
        missiles=4,
        radar_range_m=80e3,
        radar_half_angle_rad=1.05,
        range_m=30e3,
        tail_fraction=0.75,
        spread=0.2,
        range_min_m=2e3,
        interval_s=12.0,
    ),
    missile=Missile(
        mass_kg=160.0,
        propellant_kg=50.0,
        thrust_n=10e3,
        burn_s=8.0,
        area_m2=0.025,
        cd0=0.63,
        induced_drag=0.05,
        navigation_constant=4.0,
        load_factor_max=30.0,
        full_load_pressure_pa=40e3,
        lag_s=0.6,
        fuse_m=12.0,
        arm_s=1.5,
        speed_min_m_s=280.0,
        age_max_s=120.0,
        opening_m=300.0,
    ),
    rules=Rules(step_s=1.0, substeps=20, max_steps=400, outside_steps=10),
    reward=Reward(exit=400.0, evaded=50.0, shot_down=-400.0, step=-0.1),
    start=Start(
        evader_x_low_m=-33e3,
        evader_x_high_m=-28e3,
        interceptor_x_low_m=5e3,
        interceptor_x_high_m=20e3,
        y_spread_m=15e3,
        heading_spread_rad=0.3,
        altitude_m=8500.0,
        altitude_spread_m=1500.0,
        evader_speed_m_s=280.0,
        interceptor_speed_m_s=290.0,
        speed_spread_m_s=20.0,
    ),
)

MISSILES = (1, 2, 3, 4)
MASKS = tuple(frozenset(masked) for size in range(5) for masked in combinations(MISSILES, size))
"""All sixteen subtask masks."""

Policy = Callable[[NDArray], NDArray]


def changed(scenario: Scenario = DRILL, **sections: dict[str, Any]) -> Scenario:
    """A scenario with some numbers of some sections replaced: `changed(missile={"fuse_m": 0.5})`."""
    parts = {name: dataclasses.replace(getattr(scenario, name), **values) for name, values in sections.items()}
    return dataclasses.replace(scenario, **parts)


def task(*masked: int, scenario: Scenario = DRILL) -> Task:
    """The drill with these missiles masked."""
    return Task(scenario, frozenset(masked))


def straight(observation: NDArray) -> NDArray:
    """Hold the heading."""
    return np.zeros((len(observation), 1))


def to_exit(observation: NDArray) -> NDArray:
    """Turn towards the middle of the exit."""
    return np.clip(observation[:, 6:7], -np.pi / 2, np.pi / 2)


def circle(observation: NDArray) -> NDArray:
    """Turn left for ever."""
    return np.full((len(observation), 1), 0.5)


def drag(observation: NDArray) -> NDArray:
    """Keep the closest missile somewhat behind the wing; head for the exit when none flies."""
    if observation.shape[1] == 7:
        return to_exit(observation)
    ranges, azimuths = observation[:, 7::2].copy(), observation[:, 8::2]
    ranges[ranges < 0.0] = np.inf
    closest = ranges.argmin(axis=1)
    azimuth = np.take_along_axis(azimuths, closest[:, None], axis=1)
    turn = azimuth - np.where(azimuth >= 0.0, 2.0, -2.0)
    flying = np.isfinite(ranges.min(axis=1))[:, None]
    return np.where(flying, np.clip(wrapped(turn), -np.pi / 2, np.pi / 2), to_exit(observation))


def random_turns(steps: int, lanes: int, seed: int = 0) -> NDArray[np.float32]:
    """Turning angles `[steps, lanes]` [rad] that change slowly enough to get somewhere."""
    draws = np.random.default_rng(seed).uniform(-0.4, 0.4, (steps, lanes))
    return draws.astype(np.float32)


@dataclasses.dataclass(frozen=True)
class Flights:
    """Lanes flown to their end; arrays over K steps and L lanes."""

    observation: NDArray[np.float32]
    """`[K + 1, L, d]`, the first before any step."""
    terms: NDArray[np.float32]
    """`[K, L, M + 2]`."""
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    """`[K, L]`."""
    outcome: NDArray[np.int32]
    killer: NDArray[np.int32]
    steps: NDArray[np.int32]
    """`[L]` at the end."""
    fates: NDArray[np.int32]
    """`[K + 1, L, M]`."""


def fly_lanes(world: World, act: Policy | NDArray, steps: int | None = None) -> Flights:
    """Fly a fresh world by a policy, or by given turns `[K, L]`, until every lane has ended or for `steps` steps."""
    observations, fates, results = [world.observation], [world.fate], list[Step]()
    turns = None if callable(act) else np.asarray(act)
    while len(results) < (steps or 10**6):
        action = act(observations[-1]) if turns is None else turns[len(results)]  # type: ignore[operator]
        results.append(world.step(action))
        observations.append(results[-1].observation)
        fates.append(world.fate)
        if steps is None and (world.outcome != Outcome.FLYING).all():
            break
    return Flights(
        observation=np.stack(observations),
        terms=np.stack([r.reward_terms for r in results]),
        terminated=np.stack([r.terminated for r in results]),
        truncated=np.stack([r.truncated for r in results]),
        outcome=world.outcome,
        killer=world.killer,
        steps=world.steps,
        fates=np.stack(fates),
    )


def launch_step(flights: Flights, lane: int, missile: int) -> int | None:
    """Index of the first observation in which a missile is no longer unlaunched, or None."""
    gone = np.flatnonzero(flights.fates[:, lane, missile - 1] != Fate.UNLAUNCHED)
    return int(gone[0]) if len(gone) else None


def wrapped(angle: NDArray | float) -> NDArray:
    """The same angle in [-pi, pi], computed another way than `sim.geometry` does."""
    return np.arctan2(np.sin(angle), np.cos(angle))


def close(a: float, b: float, tolerance: float = 1e-6) -> bool:
    """Whether two numbers agree relatively."""
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)
