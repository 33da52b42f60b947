"""What an envelope is mapped over: launch range and aspect of a shot, or any number of the scenario."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim.errors import ScenarioError, UsageError
from sim.scenario import Scenario
from sim.scenario_file import SECTIONS, parse_scenario

GEOMETRY = {"launch_range_m": (100.0, 500e3), "aspect_deg": (-180.0, 180.0), "aspect_rad": (-math.pi, math.pi)}
"""Where a shot comes from, and what is legal: distance to the evader, and the shooter's angle off the evader's nose,
left positive. The other axes are numbers of the scenario, `section.key`."""

COUNT_LIMIT = 1000

_UNITS = {
    "_rad_s": "rad/s", "_1_s": "1/s", "_m_s": "m/s", "_kg": "kg", "_m2": "m²", "_pa": "Pa", "_n": "N", "_rad": "rad",
    "_deg": "deg", "_m": "m", "_s": "s",
}  # fmt: skip


class AxisError(UsageError):
    """An axis that cannot be read, does not exist, or leaves what is legal."""


@dataclass(frozen=True)
class Axis:
    """A name and the values it takes, ascending; one value holds it still."""

    name: str
    """`launch_range_m`, `aspect_deg`, `aspect_rad`, or `section.key` of a scenario."""
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        """Reject what no shot and no scenario can have.

        Raises:
            AxisError: no such axis, a value outside its range, or a broken number where whole ones are wanted.
        """
        low, high, whole = _legal(self.name)
        for value in self.values:
            if not low <= value <= high or (whole and value != int(value)):
                kind = "a whole number" if whole else "a number"
                raise AxisError(f"{self.name} is {value:g}; legal is {kind} from {low:g} to {high:g}")

    @property
    def is_geometry(self) -> bool:
        """Whether it says where a shot comes from, and not what the scenario is like."""
        return self.name in GEOMETRY

    @property
    def quantity(self) -> str:
        """What it measures, whatever the unit: two axes of an envelope must differ in it."""
        return "aspect" if self.name.startswith("aspect_") else self.name

    @property
    def unit(self) -> str:
        """Its unit; empty for a plain number."""
        return next((unit for suffix, unit in _UNITS.items() if self.name.endswith(suffix)), "")

    @property
    def label(self) -> str:
        """The name in words, without the unit: `missile burn`."""
        suffix = next((suffix for suffix in _UNITS if self.name.endswith(suffix)), "")
        return self.name.removesuffix(suffix).replace(".", " ").replace("_", " ")


def parse_axis(text: str) -> Axis:
    """An axis from `NAME=START:END:COUNT`, both ends included; whole numbers for whole fields.

    Raises:
        AxisError: the text is not of that form, or the axis is not legal.
    """
    name, _, span = text.partition("=")
    try:
        start, end, count = (float(part) for part in span.split(":"))
    except ValueError:
        raise AxisError(f"axis '{text}' is not NAME=START:END:COUNT, as in launch_range_m=5e3:60e3:200") from None
    if not (math.isfinite(start) and math.isfinite(end) and start < end):
        raise AxisError(f"axis {name} goes from {start:g} to {end:g}; START must be below END")
    if not (2 <= count <= COUNT_LIMIT and count == int(count)):
        raise AxisError(f"axis {name} has {count:g} values; legal is a whole number from 2 to {COUNT_LIMIT}")
    values = np.linspace(start, end, int(count))
    if _legal(name)[2]:
        values = np.round(values)
        if len(np.unique(values)) < count:
            raise AxisError(f"axis {name} takes whole numbers, of which {start:g} to {end:g} has fewer than {count:g}")
    return Axis(name, tuple(values.tolist()))


def parse_held(text: str) -> Axis:
    """Something held at one value from `NAME=VALUE`.

    Raises:
        AxisError: the text is not of that form, or the value is not legal.
    """
    name, _, value = text.partition("=")
    try:
        return Axis(name, (float(value),))
    except ValueError:
        raise AxisError(f"'{text}' is not NAME=VALUE, as in launch_range_m=20e3") from None


def varied(scenario: Scenario, numbers: Mapping[str, float]) -> Scenario:
    """The scenario with some numbers, named `section.key`, replaced; checked as a file is.

    Raises:
        ScenarioError: a number outside its range, or numbers that contradict each other.
    """
    table = dataclasses.asdict(scenario)
    for name, value in numbers.items():
        section, _, key = name.partition(".")
        table[section][key] = int(value) if _legal(name)[2] and value == int(value) else value
    try:
        return parse_scenario(table, f"scenario {scenario.name}")
    except ScenarioError as error:
        changed = ", ".join(f"{name} = {value:g}" for name, value in numbers.items())
        raise ScenarioError(f"{error} (with {changed})") from None


def _legal(name: str) -> tuple[float, float, bool]:
    """Lowest and highest legal value, and whether it must be whole."""
    if name in GEOMETRY:
        return *GEOMETRY[name], False
    section, _, key = name.partition(".")
    if section not in SECTIONS or not key:
        raise AxisError(
            f"axis '{name}' is unknown; use {', '.join(GEOMETRY)}, or section.key of a scenario: {', '.join(SECTIONS)}"
        )
    fields = {field.name: field for field in dataclasses.fields(SECTIONS[section])}
    if key not in fields:
        raise AxisError(f"axis '{name}' is unknown; {section} has {', '.join(fields)}")
    return fields[key].metadata["low"], fields[key].metadata["high"], fields[key].type == "int"
