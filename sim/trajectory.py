"""One recorded engagement: the type that figures, recordings, replays and exports take."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.geometry import azimuth
from sim.task import Task
from sim.world import TRACE_AIRCRAFT, TRACE_MISSILE, Fate, Outcome, World

Act = Callable[[NDArray], NDArray]
"""A policy bound to a task: observations `[B, d]` to turning angles `[B, 1]` [rad]."""


@dataclass(frozen=True)
class BodyTrack:
    """Path of one aircraft over T recorded times."""

    position_m: NDArray[np.float64]
    """`[T, 3]` x, y, altitude."""
    heading_rad: NDArray[np.float64]
    pitch_rad: NDArray[np.float64]
    bank_rad: NDArray[np.float64]
    """`[T]` left turns positive."""
    speed_m_s: NDArray[np.float64]


@dataclass(frozen=True)
class MissileTrack:
    """Path of one missile over T recorded times; NaN while it is not in flight."""

    number: int
    position_m: NDArray[np.float64]
    heading_rad: NDArray[np.float64]
    pitch_rad: NDArray[np.float64]
    speed_m_s: NDArray[np.float64]
    range_m: NDArray[np.float64]
    """`[T]` distance to the evader."""
    azimuth_rad: NDArray[np.float64]
    """`[T]` direction of the missile relative to the evader's nose, left positive (phi_m, Fig. 12)."""
    launch_s: float
    end_s: float
    fate: Fate
    closest_m: float
    """Smallest distance to the evader, inside substeps as well; NaN when never launched."""


@dataclass(frozen=True)
class Event:
    """Something that happened once: launch, closest, evaded, shot_down, exit, left_field, timeout; branch: was left."""

    time_s: float
    kind: str
    missile: int
    text: str
    distance_m: float = math.nan


@dataclass(frozen=True)
class Departure:
    """Where a branch left the flight that it had been until then, and who flew on."""

    of: str
    """Letter of that flight: A or B."""
    policy: str
    """Who flew until then."""
    time_s: float
    headings_deg: tuple[int, ...] = ()
    """Headings flown by hand, one per decision step from then on, 0 to 359 from the x axis to the left."""
    by_hand_s: float = 0.0
    """How long they lasted."""
    then: str = ""
    """Policy that flew on after them; empty: the last heading was held."""


@dataclass(frozen=True)
class Trajectory:
    """An engagement with every recorded substep (T times) and every decision step (K steps)."""

    task: Task
    policy: str
    seed: int
    episode: int
    time_s: NDArray[np.float64]
    evader: BodyTrack
    interceptor: BodyTrack
    missiles: tuple[MissileTrack, ...]
    step_time_s: NDArray[np.float64]
    action_rad: NDArray[np.float64]
    observation: NDArray[np.float64]
    """`[K, d]` what the policy saw at each decision, metres and radians."""
    reward_terms: NDArray[np.float64]
    """`[K, M + 2]` goal, missiles 1..M of the scenario, time."""
    events: tuple[Event, ...]
    outcome: Outcome
    killer: int
    departure: Departure | None = None
    """Of a branch: where it left its original; None for a flight of its own."""

    @property
    def episode_return(self) -> float:
        """Undiscounted sum of rewards."""
        return float(self.reward_terms.sum())

    @property
    def duration_s(self) -> float:
        """Time of the last recorded instant [s]."""
        return float(self.time_s[-1])

    @property
    def success(self) -> bool:
        """Whether the evader reached the exit."""
        return self.outcome is Outcome.EXIT

    def thin(self, every: int) -> Trajectory:
        """The same engagement with only every n-th recorded time, first and last included."""
        keep = np.unique(np.append(np.arange(0, len(self.time_s), every), len(self.time_s) - 1))
        return dataclasses.replace(
            self,
            time_s=self.time_s[keep],
            evader=_thin(self.evader, keep),
            interceptor=_thin(self.interceptor, keep),
            missiles=tuple(_thin(missile, keep) for missile in self.missiles),
        )


FINITE = 2 * TRACE_AIRCRAFT
"""Columns of a trace that are finite in every sound flight; a missile's smallest distance is not, before its launch."""


def fly(
    task: Task, act: Act, policy: str, seed: int, episode: int = 0, record_every: int = 1,
    state: NDArray[np.float32] | None = None,
) -> Trajectory:  # fmt: skip
    """Fly one engagement and record it.

    Args:
        task: the task to fly.
        act: policy for the task's observations.
        policy: name of that policy, kept for captions.
        seed: with `episode` it fixes the initial state.
        episode: episode number of that seed; an evaluation's episode k is `episode=k` here.
        record_every: keep every n-th substep.
        state: initial state `[1, 10 + ...]` instead of the episode's own, columns as in `sim.start.initial_states`.
    """
    world = World(task, lanes=1, seed=seed)
    observation = world.reset(episodes=[episode], states=state)
    world.trace()
    first = world.snapshot(0)
    rows, observations, actions, terms = [first], [], [], []
    while True:
        action = np.asarray(act(observation), dtype=np.float64).reshape(1)
        observations.append(observation[0])
        actions.append(action[0])
        step = world.step(action)
        traced = world.traced(0)
        rows.append(traced[np.isfinite(traced[:, :FINITE]).all(axis=1)])
        terms.append(step.reward_terms[0])
        observation = step.observation
        if step.terminated[0] or step.truncated[0]:
            break
    trajectory = _assemble(world, policy, episode, np.concatenate(rows), (observations, actions, terms))
    return trajectory if record_every == 1 else trajectory.thin(record_every)


def _assemble(world: World, policy: str, episode: int, rows: NDArray, steps: tuple[list, list, list]) -> Trajectory:
    rules = world.task.scenario.rules
    time = np.arange(len(rows), dtype=np.float64) * (rules.step_s / rules.substeps)
    evader, interceptor = _body(rows[:, :TRACE_AIRCRAFT]), _body(rows[:, TRACE_AIRCRAFT : 2 * TRACE_AIRCRAFT])
    missiles = tuple(_missile(number, rows, time, evader) for number in world.task.missiles)
    outcome = Outcome(int(world.outcome[0]))
    observations, actions, terms = steps
    return Trajectory(
        world.task, policy, world.seed, episode, time, evader, interceptor, missiles,
        step_time_s=np.arange(len(actions), dtype=np.float64) * rules.step_s,
        action_rad=np.array(actions, dtype=np.float64),
        observation=np.array(observations, dtype=np.float64),
        reward_terms=np.array(terms, dtype=np.float64).round(6),
        events=_events(missiles, outcome, time),
        outcome=outcome,
        killer=int(world.killer[0]),
    )  # fmt: skip


def _body(columns: NDArray) -> BodyTrack:
    columns = columns.astype(np.float64)
    return BodyTrack(columns[:, :3], columns[:, 5], columns[:, 4], columns[:, 6], columns[:, 3])


def _missile(number: int, rows: NDArray, time: NDArray, evader: BodyTrack) -> MissileTrack:
    start = 2 * TRACE_AIRCRAFT + TRACE_MISSILE * (number - 1)
    columns = rows[:, start : start + TRACE_MISSILE].astype(np.float64)
    fates, closest = columns[:, 6], columns[:, 7]
    launched = fates != Fate.UNLAUNCHED
    ended = np.flatnonzero(fates >= Fate.EVADED)
    # The substep in which a missile ends still shows where it ended.
    flying = (fates == Fate.FLYING) | (np.arange(len(fates)) == (ended[0] if len(ended) else -1))
    position, velocity = (np.where(flying[:, None], columns[:, c : c + 3], np.nan) for c in (0, 3))
    speed = np.linalg.norm(velocity, axis=1)
    return MissileTrack(
        number, position,
        heading_rad=np.arctan2(velocity[:, 1], velocity[:, 0]),
        pitch_rad=np.arcsin(np.divide(velocity[:, 2], speed, out=np.full_like(speed, np.nan), where=speed > 0)),
        speed_m_s=speed,
        range_m=np.linalg.norm(position - evader.position_m, axis=1),
        azimuth_rad=azimuth(evader.position_m[:, :2], evader.heading_rad, position[:, :2]),
        launch_s=float(time[launched][0]) if launched.any() else math.nan,
        end_s=float(time[ended[0]]) if len(ended) else math.nan,
        fate=Fate(int(fates[-1])),
        closest_m=float(closest[-1]) if launched.any() else math.nan,
    )  # fmt: skip


def _events(missiles: tuple[MissileTrack, ...], outcome: Outcome, time_s: NDArray) -> tuple[Event, ...]:
    events = [event for missile in missiles for event in _missile_events(missile, time_s)]
    end_s = float(time_s[-1])
    endings = {
        Outcome.EXIT: Event(end_s, "exit", 0, "exit reached"),
        Outcome.LEFT_FIELD: Event(end_s, "left_field", 0, "left the battlefield"),
        Outcome.TIMEOUT: Event(end_s, "timeout", 0, "step limit reached"),
        Outcome.NOT_FINITE: Event(end_s, "not_finite", 0, "a number was no longer finite; the episode is void"),
    }
    if outcome in endings:
        events.append(endings[outcome])
    return tuple(sorted(events, key=lambda event: event.time_s))


def _missile_events(m: MissileTrack, time_s: NDArray) -> list[Event]:
    if m.fate is Fate.UNLAUNCHED:
        return []
    distance = float(m.range_m[np.flatnonzero(np.isfinite(m.range_m))[0]])
    events = [
        Event(
            m.launch_s,
            "launch",
            m.number,
            f"missile {m.number} launched at {distance / 1e3:.1f} km",
            distance,
        )
    ]
    if m.fate is Fate.EVADED:
        # The time is that of the nearest record; the distance is the exact one from inside the substep.
        at = float(time_s[np.nanargmin(m.range_m)])
        text = f"missile {m.number} closest, {_distance(m.closest_m)}"
        events.append(Event(at, "closest", m.number, text, m.closest_m))
        events.append(Event(m.end_s, "evaded", m.number, f"missile {m.number} evaded"))
    if m.fate is Fate.HIT:
        text = f"shot down by missile {m.number}, {_distance(m.closest_m)}"
        events.append(Event(m.end_s, "shot_down", m.number, text, m.closest_m))
    return events


def _distance(metres: float) -> str:
    return f"{metres:.0f} m" if metres < 1000.0 else f"{metres / 1e3:.1f} km"


def _thin(track: BodyTrack | MissileTrack, keep: NDArray) -> BodyTrack | MissileTrack:
    arrays = {f.name: getattr(track, f.name) for f in dataclasses.fields(track)}
    return dataclasses.replace(track, **{k: v[keep] for k, v in arrays.items() if isinstance(v, np.ndarray)})
