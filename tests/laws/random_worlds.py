"""Worlds that nobody chose: scenarios with drawn numbers, tame ones that fly well and wild ones that are only legal."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from sim.scenario import Scenario
from sim.task import Task
from tests.engagements import DRILL

PHYSICS = ("battlefield", "evader", "interceptor", "launch", "missile", "start")


def tame_task(draw: np.random.Generator) -> Task:
    """A drill with numbers 0.7 to 1.4 times as large, one to eight missiles, and a random mask."""
    sections = {name: _scaled(getattr(DRILL, name), draw) for name in PHYSICS}
    missiles = int(draw.integers(1, 9))
    sections["launch"] = dataclasses.replace(sections["launch"], missiles=missiles)
    sections["reward"] = _scaled(DRILL.reward, draw)
    masked = np.flatnonzero(draw.random(missiles) < 0.4) + 1
    return Task(dataclasses.replace(DRILL, **sections), frozenset(masked.tolist()))


def wild_scenario(draw: np.random.Generator) -> Scenario:
    """Numbers anywhere in their legal range, among others that are the drill's; a minute at most."""
    chosen = [name for name in PHYSICS if draw.random() < 0.6]
    sections = {name: _anywhere(getattr(DRILL, name), draw) for name in chosen}
    rules = dataclasses.replace(DRILL.rules, substeps=int(draw.integers(1, 25)), max_steps=60)
    return dataclasses.replace(DRILL, rules=rules, **sections)


def _scaled(section: Any, draw: np.random.Generator) -> Any:
    numbers = {
        field.name: getattr(section, field.name) * draw.uniform(0.7, 1.4)
        for field in dataclasses.fields(section)
        if isinstance(getattr(section, field.name), float)
    }
    return dataclasses.replace(section, **numbers)


def _anywhere(section: Any, draw: np.random.Generator) -> Any:
    numbers = {}
    for field in dataclasses.fields(section):
        low, high = field.metadata["low"], field.metadata["high"]
        if draw.random() < 0.5:
            continue
        number = math.exp(draw.uniform(math.log(low), math.log(high))) if low > 0 else draw.uniform(low, high)
        numbers[field.name] = round(number) if isinstance(getattr(section, field.name), int) else number
    return dataclasses.replace(section, **numbers)
