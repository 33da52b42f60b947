"""Scenarios: every number of the world in one frozen object, read from a TOML file and checked."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from sim.assets import asset_path
from sim.errors import ScenarioError


def ranged(low: float, high: float) -> Any:
    """A required number with its legal range; the unit is part of the field's name."""
    return dataclasses.field(metadata={"low": low, "high": high})


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

    @property
    def digest(self) -> str:
        """Twelve hex digits over all numbers (not the name): policy cards and evaluations carry it."""
        numbers = {k: v for k, v in dataclasses.asdict(self).items() if k not in ("name", "description")}
        return hashlib.sha256(json.dumps(numbers, sort_keys=True).encode()).hexdigest()[:12]


SECTIONS: dict[str, type] = {
    "battlefield": Battlefield, "evader": Aircraft, "interceptor": Aircraft, "launch": Launch, "missile": Missile,
    "rules": Rules, "reward": Reward, "start": Start,
}  # fmt: skip


def scenario_names() -> list[str]:
    """Names of the shipped scenarios, sorted."""
    return sorted(path.stem for path in asset_path("scenarios").glob("*.toml"))


@cache
def load_scenario(name: str = "default") -> Scenario:
    """The shipped scenario of that name, or the one in the file of that path.

    Raises:
        ScenarioError: no such scenario, or the file is damaged; names the key, the value and the legal range.
    """
    path = Path(name) if name.endswith(".toml") else asset_path("scenarios", f"{name}.toml")
    if not path.is_file():
        raise ScenarioError(f"no scenario '{name}'; there are {', '.join(scenario_names())}, or a path to a .toml file")
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:  # damaged TOML or UTF-8, and whole numbers of thousands of digits
        raise ScenarioError(f"scenario file {path} is not TOML: {error}") from None
    return parse_scenario(table, str(path))


def parse_scenario(table: dict[str, Any], origin: str) -> Scenario:
    """A scenario from nested tables as in a file; `origin` is named in errors.

    Raises:
        ScenarioError: a key is unknown or missing, or a value has the wrong type or lies outside its range.
    """
    _check_keys(table, {"name", "description", *SECTIONS}, origin)
    for key in ("name", "description"):
        if not isinstance(table[key], str):
            raise ScenarioError(f"{origin}: {key} must be text, not {table[key]!r}")
    sections = {key: _section(cls, table[key], f"{origin}: {key}") for key, cls in SECTIONS.items()}
    scenario = Scenario(name=table["name"], description=table["description"], **sections)
    _check_relations(scenario, origin)
    return scenario


def _section(cls: type, table: Any, origin: str) -> Any:
    if not isinstance(table, dict):
        raise ScenarioError(f"{origin} must be a table, not {table!r}")
    fields = {field.name: field for field in dataclasses.fields(cls)}
    _check_keys(table, set(fields), origin)
    return cls(**{key: _number(table[key], field, f"{origin}.{key}") for key, field in fields.items()})


def _check_keys(table: dict[str, Any], legal: set[str], origin: str) -> None:
    unknown, missing = sorted(set(table) - legal), sorted(legal - set(table))
    if unknown:
        raise ScenarioError(f"{origin}: unknown key '{unknown[0]}'; legal are {', '.join(sorted(legal))}")
    if missing:
        raise ScenarioError(f"{origin}: key '{missing[0]}' is missing")


def _number(value: Any, field: dataclasses.Field, origin: str) -> float | int:
    low, high = field.metadata["low"], field.metadata["high"]
    whole = field.type == "int"
    legal = f"a {'whole ' if whole else ''}number from {low:g} to {high:g}"
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
        raise ScenarioError(f"{origin} is {value!r}; legal is {legal}")
    if not low <= value <= high:  # NaN lies in no range
        raise ScenarioError(f"{origin} is {value}; legal is {legal}")
    return int(value) if whole else float(value)


def _check_relations(scenario: Scenario, origin: str) -> None:
    start, missile, field = scenario.start, scenario.missile, scenario.battlefield
    rules = (
        (start.evader_x_low_m <= start.evader_x_high_m, "start.evader_x_low_m exceeds start.evader_x_high_m"),
        (
            start.interceptor_x_low_m <= start.interceptor_x_high_m,
            "start.interceptor_x_low_m exceeds interceptor_x_high_m",
        ),
        (-field.length_m / 2 <= start.evader_x_low_m, "start.evader_x_low_m lies left of the battlefield"),
        (start.evader_x_high_m < field.length_m / 2, "start.evader_x_high_m lies at or beyond the exit edge"),
        (start.y_spread_m <= field.width_m / 2, "start.y_spread_m exceeds half the battlefield's width"),
        (missile.propellant_kg < missile.mass_kg, "missile.propellant_kg is not below missile.mass_kg"),
        (
            abs(field.exit_y_m) + field.exit_half_width_m <= field.width_m / 2,
            "the exit gate reaches beyond the right edge",
        ),
        (start.altitude_spread_m < start.altitude_m, "start.altitude_spread_m is not below start.altitude_m"),
    )
    for holds, sentence in rules:
        if not holds:
            raise ScenarioError(f"{origin}: {sentence}")
