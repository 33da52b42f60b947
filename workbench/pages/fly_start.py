"""Where the flights of the Fly page start: an episode of a seed, or one missile fired at once from a given place."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from agents.envelope_axis import GEOMETRY
from agents.shot import shot_states, shot_task
from agents.task import FloatArray
from sim.task import Task

EPISODE_MAX = 999_999
SPARE_S = 60.0
"""A replay of a shot goes on for so long after the missile's longest flight [s]: a policy need not find the exit."""


@dataclass(frozen=True)
class Shot:
    """One missile fired at once from a distance and a side."""

    range_m: float
    """Distance to the evader [m]."""
    aspect_deg: float
    """The shooter's angle off the evader's nose [deg], left positive."""

    @property
    def text(self) -> str:
        """As in an address: range [m], aspect [deg]."""
        return f"{self.range_m:g},{self.aspect_deg:g}"


class Start(Protocol):
    """What of the page's settings says where flights start."""

    @property
    def seed(self) -> int:
        """Seed of the initial states."""
        ...

    @property
    def episode(self) -> int:
        """Number of the initial state."""
        ...

    @property
    def shot(self) -> Shot | None:
        """A shot instead."""
        ...


def read_start(query: Mapping[str, str]) -> tuple[dict[str, Any], list[str]]:
    """`episode` and `shot` of an address as far as they are right, and a sentence for each that is wrong."""
    start: dict[str, Any] = {}
    problems = []
    if text := query.get("episode", ""):
        if text.isascii() and text.isdigit() and len(text) < 8 and int(text) <= EPISODE_MAX:
            start["episode"] = int(text)
        else:
            problems.append(f"Episode '{text[:60]}' is not a whole number from 0 to {EPISODE_MAX}, so 0 is flown.")
    if text := query.get("shot", ""):
        start["shot"] = shot = _shot(text)
        if shot is None:
            problems.append(
                f"Shot '{text[:60]}' is not RANGE,ASPECT in metres and degrees, as in 22000,-40, so the whole "
                "engagement is flown."
            )
    return start, problems


def start_of(task: Task, start: Start) -> tuple[Task, FloatArray | None]:
    """The task that is flown and its initial state `[1, 10 + ...]`, None for the episode's own.

    Raises:
        MaskError: a shot, and all missiles are masked.
    """
    if start.shot is None:
        return task, None
    scenario = task.scenario
    steps = math.ceil((scenario.missile.age_max_s + SPARE_S) / scenario.rules.step_s)
    flown = shot_task(scenario, task.masked, {"rules.max_steps": steps})
    place = np.array([start.shot.range_m]), np.array([math.radians(start.shot.aspect_deg)])
    return flown, shot_states(flown.scenario, *place, start.seed, np.array([start.episode]))


def start_notes(start: Start) -> tuple[str, ...]:
    """A sentence where flights do not start as usual."""
    if start.shot is not None:
        side, degrees = "left" if start.shot.aspect_deg > 0 else "right", abs(start.shot.aspect_deg)
        where = {0.0: "ahead", 180.0: "behind"}.get(degrees, f"{degrees:g}° {side} of the nose")
        return (f"One missile, fired at once from {start.shot.range_m / 1e3:.1f} km, {where}.",)
    return (f"Episode {start.episode} of seed {start.seed}.",) if start.episode else ()


def _shot(text: str) -> Shot | None:
    try:
        range_m, aspect_deg = (float(part) for part in text.split(","))
    except ValueError:
        return None
    for value, axis in ((range_m, "launch_range_m"), (aspect_deg, "aspect_deg")):
        low, high = GEOMETRY[axis]
        if not low <= value <= high:
            return None
    return Shot(range_m, aspect_deg)
