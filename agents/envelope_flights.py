"""Many engagements flown side by side until each is decided; their lanes are filled again at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agents.policy import Act
from agents.task import BoolArray, FloatArray, IntArray
from sim.task import Task
from sim.world import Fate, Outcome, World

LANES = 1024
"""Engagements flown side by side: enough that a step's Python costs little, few enough to stay in the cache."""
LANES_PER_THREAD = 128
"""With fewer, handing out the work takes longer than what is saved."""


@dataclass(frozen=True)
class Flights:
    """How n engagements ended."""

    survived: BoolArray
    """`[n]` not shot down."""
    exited: BoolArray
    """`[n]` reached the exit."""
    closest_m: NDArray[np.float64]
    """`[n]` closest approach of any missile [m]; infinite when none was fired."""
    time_s: NDArray[np.float64]
    """`[n]` time until the engagement was decided [s], whole decision steps."""


def fly_flights(
    task: Task,
    act: Act,
    states: FloatArray,
    episodes: IntArray,
    *,
    seed: int,
    threads: int = 1,
    lanes: int = LANES,
    shots: bool = False,
    progress: Callable[[int], None] | None = None,
) -> Flights:
    """Fly one engagement from each initial state `[n, 10 + ...]`, with what its episode number `[n]` decides.

    Args:
        task: what all of them fly.
        act: the policy for the task's observations.
        states: initial states, columns as in `sim.start.initial_states`.
        episodes: episode numbers, for what is drawn during a flight.
        seed: seed of those draws.
        threads: at most so many share the lanes; flights do not depend on it.
        lanes: at most so many are flown side by side.
        shots: end a flight as soon as no missile can hit any more, not when the evader has come to the end.
        progress: told how many flights are decided.
    """
    count = len(states)
    lanes = min(lanes, count)
    world = World(task, lanes, seed, threads=max(1, min(threads, lanes // LANES_PER_THREAD)))
    record = _Record(task, count)
    flight, begun = np.arange(world.lanes), world.lanes
    active = np.ones(world.lanes, bool)
    actions = np.zeros((world.lanes, 1), np.float32)
    observation = world.reset(episodes=episodes[flight], states=states[flight])
    while active.any():
        actions[active] = act(observation[active])
        observation = world.step(actions).observation
        over = np.flatnonzero(active & _decided(world, shots))
        if not len(over):
            continue
        record.finish(flight[over], over, world)
        refilled, idle = np.split(over, [min(len(over), count - begun)])
        active[idle] = False
        if len(refilled):
            flight[refilled] = begun + np.arange(len(refilled))
            begun += len(refilled)
            observation = world.reset(refilled, episodes[flight[refilled]], states[flight[refilled]])
        if progress is not None:
            progress(record.done)
    return record.flights


def _decided(world: World, shots: bool) -> BoolArray:
    """`[L]` whether the episode is over or, for `shots`, whether every missile is."""
    ended = world.outcome != Outcome.FLYING
    if not shots:
        return ended
    mine = np.array(world.task.missiles) - 1
    return ended | (world.fate[:, mine] >= Fate.EVADED).all(axis=1)


class _Record:
    """Collects decided flights by their number."""

    def __init__(self, task: Task, count: int) -> None:
        self._step_s = task.scenario.rules.step_s
        self.flights = Flights(np.zeros(count, bool), np.zeros(count, bool), np.zeros(count), np.zeros(count))
        self.done = 0

    def finish(self, index: IntArray, lanes: IntArray, world: World) -> None:
        outcome = world.outcome[lanes]
        self.flights.survived[index] = ~np.isin(outcome, (Outcome.SHOT_DOWN, Outcome.NOT_FINITE))
        self.flights.exited[index] = outcome == Outcome.EXIT
        self.flights.closest_m[index] = world.closest[lanes].min(axis=1)
        self.flights.time_s[index] = world.steps[lanes] * self._step_s
        self.done += len(index)
