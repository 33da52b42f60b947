"""The engagements of Fig. 10 and 11, seen from above: both policies from an initial state that the Fly page shows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sim.task import task_for
from sim.trajectory import MissileTrack, Trajectory
from workbench.reproduce.azimuth_flights import MOST_EPISODES, both_win
from workbench.reproduce.protocol import SCENARIO
from workbench.reproduce.result_set import Replay, ReplayMissile

EVERY_S: Final = 4.0
"""Time between two points of a track."""
Point = tuple[float, float]


def shared_replays(told: Callable[[int], None] = lambda seed: None) -> tuple[Replay, ...]:
    """Flights of the first seed of the Fly page with which both policies evade all missiles and reach the exit.

    Empty when there is none among the first 200. `told` hears every seed that is tried.
    """
    task = task_for(SCENARIO)
    for seed in range(MOST_EPISODES):
        told(seed)
        flown = both_win(task, seed, 0)
        if flown:
            return tuple(replay_of(variant, trajectory) for variant, trajectory in flown)
    return ()


def replay_of(variant: str, trajectory: Trajectory) -> Replay:
    """A flight's tracks from above, thinned, in kilometres."""
    step_s = float(trajectory.time_s[1] - trajectory.time_s[0])
    rows = np.arange(0, len(trajectory.time_s), max(round(EVERY_S / step_s), 1))
    rows = np.unique(np.append(rows, len(trajectory.time_s) - 1))
    field = trajectory.task.scenario.battlefield
    return Replay(
        variant=variant,
        policy=trajectory.policy,
        seed=trajectory.seed,
        outcome=trajectory.outcome.name.lower(),
        duration_s=round(trajectory.duration_s, 1),
        moment_s=round(busiest_s(trajectory), 1),
        field_km=(field.length_m / 1e3, field.width_m / 1e3),
        exit_km=(field.exit_y_m / 1e3, field.exit_half_width_m / 1e3),
        time_s=tuple(round(float(time), 1) for time in trajectory.time_s[rows]),
        evader_km=_track(trajectory.evader.position_m[rows]),
        interceptor_km=_track(trajectory.interceptor.position_m[rows]),
        missiles=tuple(_missile(missile, rows) for missile in trajectory.missiles),
        scenario_digest=trajectory.task.scenario.digest,
    )


def busiest_s(trajectory: Trajectory) -> float:
    """When most missiles fly, and of those times the one with the closest missile nearest [s]."""
    ranges = np.stack([missile.range_m for missile in trajectory.missiles])
    flying = np.isfinite(ranges).sum(axis=0)
    nearest = np.where(np.isfinite(ranges), ranges, np.inf).min(axis=0)
    nearest[flying < flying.max()] = np.inf
    return float(trajectory.time_s[int(nearest.argmin())])


def _missile(missile: MissileTrack, rows: NDArray[np.intp]) -> ReplayMissile:
    end_s = missile.end_s if math.isfinite(missile.end_s) else None
    flown = missile.position_m[rows]
    return ReplayMissile(
        number=missile.number,
        fate=missile.fate.name.lower(),
        end_s=None if end_s is None else round(end_s, 1),
        first=int(np.isfinite(flown[:, 0]).argmax()),
        track_km=_track(flown[np.isfinite(flown[:, 0])]),
    )


def _track(position_m: NDArray[np.float64]) -> tuple[Point, ...]:
    return tuple((round(float(x) / 1e3, 2), round(float(y) / 1e3, 2)) for x, y in position_m[:, :2])
