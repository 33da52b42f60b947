"""Every substep of many lanes as arrays, and the physics of the page written once more, for laws to be checked on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.task import Task
from sim.world import TRACE_AIRCRAFT, TRACE_MISSILE, Fate, World
from tests.engagements import DRILL, Policy

GRAVITY = 9.80665
DT = DRILL.rules.step_s / DRILL.rules.substeps
MACH = (0.0, 0.6, 1.0, 1.2, 2.0, 3.0, 4.0, 9.0)
DRAG_SHARE = (0.532, 0.532, 0.853, 1.0, 0.819, 0.630, 0.504, 0.504)
"""Zero-lift drag by Mach number, relative to its peak."""


@dataclass(frozen=True)
class Body:
    """One aircraft per lane over T substeps, NaN once the lane has ended."""

    position: NDArray[np.float64]
    """`[L, T, 3]`."""
    speed: NDArray[np.float64]
    climb: NDArray[np.float64]
    heading: NDArray[np.float64]
    bank: NDArray[np.float64]
    """`[L, T]`."""


@dataclass(frozen=True)
class Flight:
    """One missile from the substep it was fired in to its last: n + 1 times."""

    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    """`[n + 1, 3]`."""

    @property
    def age(self) -> NDArray[np.float64]:
        """Seconds since it was fired `[n]`, at the start of each substep."""
        return np.arange(len(self.position) - 1) * DT


def zigzag(observation: NDArray) -> NDArray:
    """Hard over to one side, then to the other, by position."""
    return np.where(np.floor(observation[:, :1] / 1500.0) % 2 == 0, 1.5, -1.5)


def fly_tracks(
    task: Task, act: Policy | NDArray, steps: int, lanes: int, seed: int = 3, states: NDArray | None = None
) -> NDArray[np.float64]:
    """Rows `[L, T, 14 + 8 M]` of every substep, as `kernel.write_trace` writes them; NaN once a lane has ended."""
    world, substeps = World(task, lanes, seed), task.scenario.rules.substeps
    if states is not None:
        world.reset(states=states)
    world.trace()
    width = 2 * TRACE_AIRCRAFT + TRACE_MISSILE * task.scenario.launch.missiles
    rows = np.full((lanes, steps * substeps, width), np.nan)
    for k in range(steps):
        flying = np.flatnonzero(world.outcome == 0)
        world.step(act(world.observation) if callable(act) else act[k])
        for lane in flying:
            new = world.traced(lane)
            rows[lane, k * substeps : k * substeps + len(new)] = new
    return rows


def body(rows: NDArray, side: int) -> Body:
    """The evader (0) or the interceptor (1) of all lanes."""
    own = rows[..., TRACE_AIRCRAFT * side : TRACE_AIRCRAFT * (side + 1)]
    return Body(own[..., :3], own[..., 3], own[..., 4], own[..., 5], own[..., 6])


def missiles(rows: NDArray) -> list[Flight]:
    """Every missile that flew for at least three seconds, of all lanes."""
    own = rows[..., 2 * TRACE_AIRCRAFT :].reshape(*rows.shape[:2], -1, TRACE_MISSILE)
    found = []
    for path in own.swapaxes(1, 2).reshape(-1, rows.shape[1], TRACE_MISSILE):
        flying = np.flatnonzero(path[:, 6] == Fate.FLYING)
        if len(flying) > 60:
            # The substep in which it ends still shows where.
            path = path[flying[0] : flying[-1] + 2]
            path = path[np.isfinite(path[:, 0])]
            # When a lower number hits, the others do not move in that substep any more.
            path = path[: len(path) - (path[-1, :3] == path[-2, :3]).all()]
            found.append(Flight(path[:, :3], path[:, 3:6]))
    return found


def density(altitude: NDArray) -> NDArray:
    """ISA air density [kg/m^3] by the hydrostatic equation, in double precision and another way than the kernel."""
    grid = np.linspace(0.0, 25e3, 250_001)
    kelvin = np.maximum(288.15 - 0.0065 * grid, 216.65)
    fall = GRAVITY / (287.05287 * kelvin)
    steps = (fall[1:] + fall[:-1]) / 2 * np.diff(grid)
    pressure = 101325.0 * np.exp(-np.concatenate([[0.0], np.cumsum(steps)]))
    return np.interp(altitude, grid, pressure / (287.05287 * kelvin))


def sound(altitude: NDArray) -> NDArray:
    """Speed of sound [m/s] of the ISA."""
    return np.sqrt(1.4 * 287.05287 * np.maximum(288.15 - 0.0065 * altitude, 216.65))


def load_factor(b: Body) -> NDArray:
    """Load factor `[L, T - 1]` from the turn rates of the recorded path."""
    turn = np.diff(b.heading)
    turn = np.arctan2(np.sin(turn), np.cos(turn))
    speed, climb = b.speed[:, :-1], b.climb[:, :-1]
    sideways = speed * np.cos(climb) * turn / DT / GRAVITY
    upwards = speed * np.diff(b.climb) / DT / GRAVITY + np.cos(climb)
    return np.hypot(sideways, upwards)


def pull(m: Flight) -> tuple[NDArray, NDArray]:
    """Nose `[n, 3]` at the start of each substep and the acceleration across it `[n]` [m/s^2], gravity taken off."""
    acceleration = np.diff(m.velocity, axis=0) / DT + [0.0, 0.0, GRAVITY]
    nose = m.velocity[:-1] / np.linalg.norm(m.velocity[:-1], axis=1, keepdims=True)
    across = acceleration - (acceleration * nose).sum(axis=1, keepdims=True) * nose
    return nose, np.linalg.norm(across, axis=1)
