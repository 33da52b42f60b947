"""Scenarios: every number of the world in one frozen object; `sim.scenario_file` reads and checks them."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from dataclasses import dataclass
from typing import Any


def ranged(low: float, high: float) -> Any:
    """A required number with its legal range; the unit is part of the field's name."""
    return dataclasses.field(metadata={"low": low, "high": high})


def off_or_up_to(high: float) -> Any:
    """A number that is 0, off, unless a scenario says otherwise."""
    return dataclasses.field(default=0.0, metadata={"low": 0.0, "high": high})


@dataclass(frozen=True)
class Battlefield:
    """Rectangle centred on the origin; the exit lies on its right edge (Fig. 2)."""

    length_m: float = ranged(10e3, 1000e3)
    width_m: float = ranged(10e3, 1000e3)
    exit_y_m: float = ranged(-500e3, 500e3)
    exit_half_width_m: float = ranged(100.0, 100e3)


@dataclass(frozen=True)
class Aircraft:
    """Three-degree-of-freedom aircraft with a built-in heading, altitude and speed controller (section 2.3)."""

    mass_kg: float = ranged(100.0, 100e3)
    wing_area_m2: float = ranged(0.5, 200.0)
    cd0: float = ranged(0.001, 0.5)
    induced_drag: float = ranged(0.001, 2.0)
    cl_max: float = ranged(0.1, 3.0)
    load_factor_max: float = ranged(1.1, 15.0)
    roll_rate_max_rad_s: float = ranged(0.05, 10.0)
    thrust_max_n: float = ranged(100.0, 1e6)
    heading_gain_1_s: float = ranged(0.05, 5.0)


@dataclass(frozen=True)
class Launch:
    """When the interceptor may fire: radar, launch zone by aspect, interval."""

    missiles: int = ranged(1, 8)
    radar_range_m: float = ranged(1e3, 1000e3)
    radar_half_angle_rad: float = ranged(0.05, math.pi)
    range_m: float = ranged(1e3, 500e3)
    tail_fraction: float = ranged(0.05, 1.0)
    spread: float = ranged(0.0, 0.9)
    range_min_m: float = ranged(0.0, 100e3)
    interval_s: float = ranged(1.0, 600.0)


@dataclass(frozen=True)
class Missile:
    """Point mass with a boost motor, proportional navigation, autopilot lag and a proximity fuse."""

    mass_kg: float = ranged(1.0, 2000.0)
    propellant_kg: float = ranged(0.0, 1500.0)
    thrust_n: float = ranged(0.0, 1e6)
    burn_s: float = ranged(0.0, 200.0)
    area_m2: float = ranged(1e-4, 5.0)
    cd0: float = ranged(0.001, 5.0)
    induced_drag: float = ranged(0.0, 10.0)
    navigation_constant: float = ranged(1.0, 10.0)
    load_factor_max: float = ranged(1.0, 100.0)
    full_load_pressure_pa: float = ranged(0.0, 1e6)
    lag_s: float = ranged(0.01, 5.0)
    fuse_m: float = ranged(0.5, 1000.0)
    arm_s: float = ranged(0.0, 30.0)
    speed_min_m_s: float = ranged(50.0, 2000.0)
    age_max_s: float = ranged(5.0, 600.0)
    opening_m: float = ranged(1.0, 10e3)


@dataclass(frozen=True)
class Rules:
    """Decision step, substeps and when an episode ends (section 2.3)."""

    step_s: float = ranged(0.05, 10.0)
    substeps: int = ranged(1, 1000)
    max_steps: int = ranged(1, 100_000)
    outside_steps: int = ranged(0, 100_000)


@dataclass(frozen=True)
class Reward:
    """The four numbers of the paper's sparse reward (section 2.3)."""

    exit: float = ranged(-1e6, 1e6)
    evaded: float = ranged(-1e6, 1e6)
    shot_down: float = ranged(-1e6, 1e6)
    step: float = ranged(-1e6, 1e6)


@dataclass(frozen=True)
class Start:
    """Random initial states: uniform between low and high, both aircraft on opposite sides (section 2.3)."""

    evader_x_low_m: float = ranged(-500e3, 500e3)
    evader_x_high_m: float = ranged(-500e3, 500e3)
    interceptor_x_low_m: float = ranged(-500e3, 500e3)
    interceptor_x_high_m: float = ranged(-500e3, 500e3)
    y_spread_m: float = ranged(0.0, 500e3)
    heading_spread_rad: float = ranged(0.0, math.pi)
    altitude_m: float = ranged(500.0, 18e3)
    altitude_spread_m: float = ranged(0.0, 5e3)
    evader_speed_m_s: float = ranged(50.0, 600.0)
    interceptor_speed_m_s: float = ranged(50.0, 600.0)
    speed_spread_m_s: float = ranged(0.0, 100.0)


@dataclass(frozen=True)
class Variation:
    """How shots differ from one another: each draws uniform factors 1 - spread .. 1 + spread, seeded by episode."""

    interval_spread: float = off_or_up_to(0.9)
    thrust_spread: float = off_or_up_to(0.9)
    drag_spread: float = off_or_up_to(0.9)
    navigation_spread: float = off_or_up_to(0.9)
    lag_spread: float = off_or_up_to(0.9)


@dataclass(frozen=True)
class Sensor:
    """What the evader's missile warning makes of the truth: Gaussian noise, lost contacts, a late first warning."""

    range_noise_m: float = off_or_up_to(10e3)
    azimuth_noise_rad: float = off_or_up_to(1.0)
    drop_out: float = off_or_up_to(1.0)
    warning_delay_s: float = off_or_up_to(120.0)


@dataclass(frozen=True)
class Scenario:
    """Everything that defines the world; equal scenarios give equal flights."""

    name: str
    description: str
    battlefield: Battlefield
    evader: Aircraft
    interceptor: Aircraft
    launch: Launch
    missile: Missile
    rules: Rules
    reward: Reward
    start: Start
    variation: Variation = Variation()
    sensor: Sensor = Sensor()

    @property
    def digest(self) -> str:
        """Twelve hex digits over all numbers (not the name): policy cards and evaluations carry it.

        What may be off counts only when it is on, so that a world keeps its digest when a new possibility is added.
        """
        numbers = {k: v for k, v in dataclasses.asdict(self).items() if k not in ("name", "description")}
        for section in ("variation", "sensor"):
            switched_on = {key: value for key, value in numbers.pop(section).items() if value}
            numbers |= {section: switched_on} if switched_on else {}
        return hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()[:12]
