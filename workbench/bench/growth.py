"""How a step of the simulator grows with lanes, missiles and substeps; what a lane weighs; a step of Gymnasium."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sim.environment import EvasionEnv
from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Fate, World
from workbench.bench.sim import four_missiles

LANES = (1, 16, 64, 256, 1024, 4096)
SUBSTEPS = (5, 10, 20, 40)
MANY = 1024
"""Lanes with which missiles and substeps are counted."""
REPEATS = 30
"""The shortest of so many steps is taken: whatever else the machine does can only make one longer."""


@dataclass(frozen=True)
class GrowthCase:
    """Time of one step of a world, without policy."""

    lanes: int
    missiles_flying: int
    substeps: int
    device: str
    step_us: float
    """Microseconds for one decision step of all lanes."""


@dataclass(frozen=True)
class Growth:
    """What `workbench bench sim` says besides its rates."""

    growth: list[GrowthCase]
    memory_bytes_per_lane: float
    gymnasium_step_us: float


def bench_growth(device: str = "cpu", repeats: int = REPEATS) -> Growth:
    """Measure steps with more and more lanes, missiles in flight and substeps; a minute at most."""
    cases = [GrowthCase(*shape, device, _step_us(*shape, device, repeats)) for shape in _shapes()]
    world = World(Task(load_scenario()), MANY, device=device)
    return Growth(cases, world.bytes / MANY, _gymnasium_step_us(repeats))


def _shapes() -> Iterator[tuple[int, int, int]]:
    """Lanes, missiles in flight, substeps."""
    yield from ((lanes, 0, 20) for lanes in LANES)
    yield from ((MANY, missiles, 20) for missiles in (1, 2, 4, 8))
    yield from ((MANY, 4, substeps) for substeps in SUBSTEPS if substeps != 20)


def _step_us(lanes: int, missiles: int, substeps: int, device: str, repeats: int) -> float:
    world = World(Task(_salvo(missiles, substeps)), lanes, device=device)
    turns = np.zeros(lanes)
    while missiles and not (world.fate == Fate.FLYING).all():
        world.step(turns)
    return _shortest_us(lambda: world.step(turns), repeats)


def _salvo(missiles: int, substeps: int) -> Scenario:
    """A scenario in which so many missiles fly at once, or none is ever fired."""
    plain = four_missiles(load_scenario())
    launch = dataclasses.replace(plain.launch, missiles=max(missiles, 1), range_m=500e3 if missiles else 1e3)
    rules = dataclasses.replace(plain.rules, substeps=substeps)
    return dataclasses.replace(plain, launch=launch, rules=rules)


def _gymnasium_step_us(repeats: int) -> float:
    env, turn = EvasionEnv(), np.zeros(1, dtype=np.float32)
    env.reset(seed=0)
    return _shortest_us(lambda: env.step(turn), repeats)


def _shortest_us(work: object, repeats: int) -> float:
    assert callable(work)
    spent = []
    for _ in range(repeats):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return min(spent) * 1e6
