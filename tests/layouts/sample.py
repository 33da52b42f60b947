"""A flight made by formulas, so that every curve of it is known: 200 s, evader along +x, missiles one after another."""

from __future__ import annotations

import math

import numpy as np

from sim.scenario_file import load_scenario
from sim.task import Task
from sim.trajectory import BodyTrack, Event, MissileTrack, Trajectory
from sim.world import Fate, Outcome

SPEED_M_S = 250.0
END_S = 200.0
LAUNCH_EVERY_S = 30.0
FLIGHT_S = 60.0


def sample_flight(
    masked: frozenset[int] = frozenset(), outcome: Outcome = Outcome.EXIT, per_second: int = 10
) -> Trajectory:
    """Missile k is launched at 30 k seconds and circles the evader once in 60 s, 1 km away at its closest."""
    task = Task(load_scenario(), masked)
    time = np.arange(0.0, END_S + 0.5 / per_second, 1.0 / per_second)
    shot = outcome is Outcome.SHOT_DOWN
    fates = {m: Fate.HIT if shot and m == task.missiles[-1] else Fate.EVADED for m in task.missiles}
    missiles = tuple(_missile(m, time, fates[m]) for m in task.missiles)
    steps = np.arange(0.0, END_S)
    terms = np.zeros((len(steps), task.scenario.launch.missiles + 2))
    terms[:, -1] = -0.1
    terms[-1, 0] = 400.0 if outcome is Outcome.EXIT else -400.0
    for missile in missiles:
        if missile.fate is Fate.EVADED:
            terms[int(missile.end_s) - 1, missile.number] = 50.0
    return Trajectory(
        task, "sample", 3, 0, time, _aircraft(time, 0.0, -100e3, 0.0), _aircraft(time, math.pi, 100e3, 20e3), missiles,
        steps, np.zeros(len(steps)), np.zeros((len(steps), task.layout.size)), terms, _events(missiles, outcome),
        outcome, task.missiles[-1] if shot else 0,
    )  # fmt: skip


def _aircraft(time: np.ndarray, heading: float, x_m: float, y_m: float) -> BodyTrack:
    x = x_m + math.cos(heading) * SPEED_M_S * time
    position = np.stack([x, np.full_like(time, y_m), np.full_like(time, 7000.0)], axis=1)
    level = np.zeros_like(time)
    return BodyTrack(position, np.full_like(time, heading), level, level, np.full_like(time, SPEED_M_S))


def _missile(number: int, time: np.ndarray, fate: Fate) -> MissileTrack:
    launch, end = LAUNCH_EVERY_S * number, LAUNCH_EVERY_S * number + FLIGHT_S
    flying = (time >= launch) & (time <= end)
    share = np.where(flying, (time - launch) / FLIGHT_S, np.nan)
    # One turn around the evader, from dead ahead over the left side: the azimuth wraps half-way.
    bearing = np.where(share <= 0.5, 2 * np.pi * share, 2 * np.pi * share - 2 * np.pi)
    distance = 1000.0 + 20e3 * np.abs(share - 0.5)
    evader = _aircraft(time, 0.0, -100e3, 0.0).position_m
    offset = np.stack([distance * np.cos(bearing), distance * np.sin(bearing), np.zeros_like(time)], axis=1)
    return MissileTrack(
        number, evader + offset, bearing, np.where(flying, 0.0, np.nan), np.where(flying, 800.0, np.nan),
        distance, bearing, launch, end, fate, 1000.0,
    )  # fmt: skip


def _events(missiles: tuple[MissileTrack, ...], outcome: Outcome) -> tuple[Event, ...]:
    events = [Event(m.launch_s, "launch", m.number, f"missile {m.number} launched", 11e3) for m in missiles]
    events += [Event(m.end_s, "evaded", m.number, f"missile {m.number} evaded") for m in missiles]
    kind = {Outcome.EXIT: "exit", Outcome.SHOT_DOWN: "shot_down"}.get(outcome, "timeout")
    return tuple(sorted([*events, Event(END_S, kind, 0, kind)], key=lambda event: event.time_s))
