"""The engagement of Fig. 12: both policies from one initial state, with the azimuth of every missile."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sim.task import Task, task_for
from sim.trajectory import MissileTrack, Trajectory, fly
from sim.world import Fate
from workbench.reproduce.measurements import shipped_digest
from workbench.reproduce.protocol import REPORT_SEED, SCENARIO
from workbench.reproduce.result_set import Flight, MissileCurve

PILOTS: Final = {"submas": "submas-target", "expert": "expert-dragging"}
"""Who flies: key of `protocol.LABELS` -> POLICY."""
MOST_EPISODES: Final = 200
EVERY_S: Final = 0.25
"""Time between two points of a curve."""
LEAD_S: Final = 5.0
"""Time shown before the first launch and after the last missile's end."""
BEAM_RAD: Final = math.radians(15.0)
"""How far from ±90° still counts as flying across the line of sight."""


def shared_flights(told: Callable[[int], None] = lambda episode: None) -> tuple[Flight, ...]:
    """The first reported episode in which both policies evade all missiles and reach the exit, as the paper shows one.

    Empty when there is none among the first 200. `told` hears the number of every episode that is tried.
    """
    task = task_for(SCENARIO)
    for episode in range(MOST_EPISODES):
        told(episode)
        flown = both_win(task, REPORT_SEED, episode)
        if flown:
            return tuple(flight_of(variant, trajectory) for variant, trajectory in flown)
    return ()


def both_win(task: Task, seed: int, episode: int) -> list[tuple[str, Trajectory]]:
    """Both policies' flights of one episode, by key of `protocol.LABELS`; empty unless both evade all and arrive."""
    from agents.policy import bind
    from workbench.policies import resolve_policy

    # The expert fails more often: ask it first, show it second.
    found = {}
    for variant, policy in reversed(PILOTS.items()):
        found[variant] = fly(task, bind(resolve_policy(policy), task), policy, seed, episode)
        evaded = all(missile.fate is Fate.EVADED for missile in found[variant].missiles)
        if not (evaded and found[variant].success):
            return []
    return [(variant, found[variant]) for variant in PILOTS]


def flight_of(variant: str, trajectory: Trajectory) -> Flight:
    """A flight's azimuth curves while missiles fly, thinned, in degrees."""
    starts = [missile.launch_s for missile in trajectory.missiles]
    ends = [missile.end_s for missile in trajectory.missiles]
    window = trajectory.time_s >= np.nanmin(starts) - LEAD_S
    window &= trajectory.time_s <= np.nanmax(ends) + LEAD_S
    rows = np.flatnonzero(window)
    step_s = float(trajectory.time_s[1] - trajectory.time_s[0])
    rows = rows[:: max(round(EVERY_S / step_s), 1)]
    policy = PILOTS[variant]
    return Flight(
        variant=variant,
        policy=policy,
        seed=trajectory.seed,
        episode=trajectory.episode,
        outcome=trajectory.outcome.name.lower(),
        duration_s=round(trajectory.duration_s, 2),
        beam_share=round(beam_share(trajectory), 3),
        time_s=tuple(round(float(time), 2) for time in trajectory.time_s[rows]),
        missiles=tuple(_curve(missile, rows) for missile in trajectory.missiles),
        policy_digest=shipped_digest(policy),
        scenario_digest=trajectory.task.scenario.digest,
        command="workbench reproduce fig12",
    )


def beam_share(trajectory: Trajectory) -> float:
    """Share of the time with a missile in flight in which the closest one is within 15° of ±90° off the nose."""
    ranges = np.stack([missile.range_m for missile in trajectory.missiles])
    azimuths = np.stack([missile.azimuth_rad for missile in trajectory.missiles])
    flying = np.isfinite(ranges).any(axis=0)
    closest = np.where(np.isfinite(ranges), ranges, np.inf).argmin(axis=0)
    azimuth = np.abs(azimuths[closest, np.arange(ranges.shape[1])])[flying]
    return float((np.abs(azimuth - math.pi / 2.0) <= BEAM_RAD).mean()) if flying.any() else math.nan


def _curve(missile: MissileTrack, rows: NDArray[np.intp]) -> MissileCurve:
    degrees = np.degrees(missile.azimuth_rad[rows])
    return MissileCurve(
        number=missile.number,
        fate=missile.fate.name.lower(),
        launch_s=round(missile.launch_s, 2) if math.isfinite(missile.launch_s) else None,
        end_s=round(missile.end_s, 2) if math.isfinite(missile.end_s) else None,
        azimuth_deg=tuple(round(float(angle), 1) if math.isfinite(angle) else None for angle in degrees),
    )
