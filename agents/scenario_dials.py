"""The numbers of a scenario that the paper does not publish and that a search may choose, with their ranges."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from sim.scenario import Scenario
from sim.scenario_file import parse_scenario

START_MARGIN_M = 2e3
"""Distance of the outermost start from the edge behind it."""
START_GRID_M = 500.0
CHANGED_SHARE = 0.5
STEP_SIZES = (0.03, 0.08, 0.16)
"""Standard deviations of a refinement, as shares of a dial's range; one is drawn for each proposal."""

Settings = Mapping[str, float]
"""A value for every dial, by its name."""


@dataclass(frozen=True)
class Dial:
    """One number to choose, uniform between two bounds."""

    name: str
    """`section.key` of the scenario, or one of the two that several keys are made from."""
    low: float
    high: float
    step: float
    """Values are multiples of this, so that a file reads well; they are rounded before anything is measured."""
    why: str
    """What it decides."""

    def rounded(self, value: float) -> float:
        """The nearest legal value on the grid of `step`."""
        return float(min(max(round(round(value / self.step) * self.step, 6), self.low), self.high))


DEPTH: Final = "start.depth_m"
"""Depth of the strips along the left and the right edge in which the two aircraft start."""
WIDTH_SHARE: Final = "start.width_share"
"""Share of the battlefield's width over which they start."""

DIALS: Final = (
    Dial("battlefield.length_m", 195e3, 260e3, 1e3, "length of successful flights"),
    Dial("battlefield.width_m", 75e3, 160e3, 1e3, "how soon the edges punish flying away to one side"),
    Dial("launch.range_m", 30e3, 56e3, 100.0, "difficulty: how much energy a missile has left on arrival"),
    Dial("launch.tail_fraction", 0.55, 0.95, 0.01, "whether turning away is safe"),
    Dial("launch.spread", 0.05, 0.35, 0.005, "how gradually the ladder of tasks falls"),
    Dial("launch.interval_s", 15.0, 100.0, 1.0, "how many missiles fly at once"),
    Dial("missile.thrust_n", 8500.0, 13e3, 100.0, "the missile's energy"),
    Dial("missile.cd0", 0.45, 0.75, 0.01, "difficulty: how fast it loses that energy"),
    Dial("missile.induced_drag", 0.02, 0.12, 0.01, "what turning costs it"),
    Dial("missile.lag_s", 0.45, 0.8, 0.01, "whether it can follow a hard turn at the end"),
    Dial("missile.fuse_m", 8.0, 20.0, 0.5, "how close a miss must be"),
    Dial(DEPTH, 2e3, 20e3, 500.0, "how different the beginnings are"),
    Dial(WIDTH_SHARE, 0.4, 0.85, 0.01, "how different the beginnings are"),
    Dial("start.evader_speed_m_s", 245.0, 310.0, 1.0, "length of flights, and what can be outrun"),
    Dial("start.interceptor_speed_m_s", 240.0, 335.0, 1.0, "how fast the interceptor closes in again"),
    Dial("start.altitude_m", 7000.0, 9000.0, 100.0, "air density, and so the missile's drag"),
)


def drawn(draws: np.random.Generator) -> Settings:
    """Every dial anywhere in its range."""
    return _frozen({dial.name: dial.rounded(draws.uniform(dial.low, dial.high)) for dial in DIALS})


def refined(draws: np.random.Generator, settings: Settings) -> Settings:
    """The same settings with about half of the dials moved a little."""
    size = draws.choice(STEP_SIZES)
    moved = draws.random(len(DIALS)) < CHANGED_SHARE
    shifts = size * draws.standard_normal(len(DIALS)) * moved
    return _frozen(
        {dial.name: dial.rounded(settings[dial.name] + shift * (dial.high - dial.low))
         for dial, shift in zip(DIALS, shifts, strict=True)}
    )  # fmt: skip


def with_settings(base: Scenario, settings: Settings, name: str, description: str) -> Scenario:
    """The scenario with its dials set; everything else, also the number of missiles, stays as in `base`.

    Raises:
        ScenarioError: these numbers contradict others of the scenario.
    """
    table: dict[str, Any] = dataclasses.asdict(base) | {"name": name, "description": description}
    for dial, value in settings.items():
        section, _, key = dial.partition(".")
        if dial not in (DEPTH, WIDTH_SHARE):
            table[section][key] = value
    table["start"] |= _starts(settings)
    return parse_scenario(table, f"proposal from '{base.name}'")


def _starts(settings: Settings) -> dict[str, float]:
    far = settings["battlefield.length_m"] / 2 - START_MARGIN_M
    near = far - settings[DEPTH]
    spread = settings[WIDTH_SHARE] * settings["battlefield.width_m"] / 2
    return {
        "evader_x_low_m": -far, "evader_x_high_m": -near, "interceptor_x_low_m": near, "interceptor_x_high_m": far,
        "y_spread_m": START_GRID_M * round(spread / START_GRID_M),
    }  # fmt: skip


def check_base(base: Scenario) -> None:
    """Refuse a scenario whose other numbers leave no room for some settings of the dials.

    Raises:
        ScenarioError: names what does not fit.
    """
    for end in ("low", "high"):
        with_settings(base, {dial.name: getattr(dial, end) for dial in DIALS}, base.name, base.description)


def _frozen(settings: dict[str, float]) -> Settings:
    return MappingProxyType(settings)
