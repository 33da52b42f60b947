"""One missile fired at once, from any distance and any side: the engagement behind each cell of a launch envelope."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from agents.envelope_axis import AxisError, varied
from agents.task import FloatArray
from sim.errors import MaskError
from sim.scenario import Launch, Rules, Scenario
from sim.start import initial_states
from sim.task import Task


def _high(section: type, key: str) -> float:
    return section.__dataclass_fields__[key].metadata["high"]


FREE_FIRE: dict[str, float] = {
    "launch.range_m": _high(Launch, "range_m"),
    "launch.radar_range_m": _high(Launch, "radar_range_m"),
    "launch.radar_half_angle_rad": _high(Launch, "radar_half_angle_rad"),
    "launch.tail_fraction": 1.0,
    "launch.spread": 0.0,
    "launch.range_min_m": 0.0,
    "rules.max_steps": _high(Rules, "max_steps"),
    "rules.outside_steps": _high(Rules, "outside_steps"),
    "start.altitude_spread_m": 0.0,
}
"""What makes the interceptor fire in the first substep wherever it is, and lets nothing but the missile end the
flight. How everything flies stays the scenario's."""

_ACTING_SECTIONS = ("battlefield", "evader", "interceptor", "missile", "variation", "sensor")
_ACTING_NUMBERS = ("rules.step_s", "rules.substeps", "start.altitude_m", "start.evader_speed_m_s",
                   "start.interceptor_speed_m_s")  # fmt: skip


def check_acts_on_shot(name: str) -> None:
    """Refuse a number of the scenario on which a shot fired at once does not depend.

    Raises:
        AxisError: such a number; a map over it would be the same everywhere.
    """
    acts = name.partition(".")[0] in _ACTING_SECTIONS or name in _ACTING_NUMBERS
    if not acts or name == "variation.interval_spread":
        raise AxisError(
            f"{name} has no effect on a shot that is fired at once; vary {', '.join(_ACTING_NUMBERS)} or a number of "
            f"{', '.join(_ACTING_SECTIONS)}; or give two numbers of the scenario as axes, for whole engagements"
        )


def shot_task(scenario: Scenario, masked: Iterable[int] = (), numbers: dict[str, float] | None = None) -> Task:
    """The task of one shot: `FREE_FIRE`, other numbers replaced, and every missile masked but the first that was not.

    Raises:
        MaskError: all missiles are masked.
        ScenarioError: a number that is not legal.
    """
    left = Task(scenario, frozenset(masked)).missiles
    if not left:
        raise MaskError("every missile is masked; a shot needs one that is not")
    task = Task(varied(scenario, {**FREE_FIRE, **(numbers or {})}))
    return task.mask(set(task.missiles) - {left[0]})


def shot_states(
    scenario: Scenario, range_m: NDArray[np.float64], aspect_rad: NDArray[np.float64], seed: int, episodes: NDArray
) -> FloatArray:
    """Initial states `[n, 10 + ...]` of shots from a distance `[n]` [m] and an angle off the evader's nose `[n]` [rad].

    The evader flies level along +x in the middle of the field at the scenario's altitude and speed; the shooter, as
    high, points at it. What varies from shot to shot follows from seed and episode numbers `[n]`.
    """
    different, index = np.unique(episodes, return_inverse=True)
    states = initial_states(scenario, seed, different)[index]
    start = scenario.start
    evader = (0.0, 0.0, start.altitude_m, 0.0, start.evader_speed_m_s)
    states[:, :5] = evader
    states[:, 5], states[:, 6] = range_m * np.cos(aspect_rad), range_m * np.sin(aspect_rad)
    states[:, 7], states[:, 9] = start.altitude_m, start.interceptor_speed_m_s
    states[:, 8] = aspect_rad - np.where(aspect_rad > 0.0, math.pi, -math.pi)
    return states
