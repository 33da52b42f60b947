"""The world: many lanes of one task stepped together, one decision step a call, without automatic resets."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import ArrayLike, NDArray

from sim.device import start_warp
from sim.errors import ActionError
from sim.kernel.lane import AGE, AX, BANK, CLIMB, CLOSEST, CRUISE, HEADING, LEVEL, SPEED, VX, WIDTH, IntRow, Row, X
from sim.kernel.model import kernel_model, kernel_state
from sim.kernel.restart import reset_groups
from sim.kernel.step import step_groups
from sim.scenario import Sensor
from sim.sensor import sense
from sim.start import initial_states
from sim.task import Task

TRACE_AIRCRAFT = 7
TRACE_MISSILE = 8
SHARED = ("available",)
"""Arrays of the kernel's state that belong to the task and not to a lane."""


class Outcome(IntEnum):
    """How an episode stands or ended."""

    FLYING = 0
    EXIT = 1
    SHOT_DOWN = 2
    LEFT_FIELD = 3
    TIMEOUT = 4
    NOT_FINITE = 5
    """A number of the state was no longer finite: the episode is void, no result of a policy."""


class Fate(IntEnum):
    """What has become of a missile."""

    UNLAUNCHED = 0
    FLYING = 1
    EVADED = 2
    HIT = 3


@dataclass(frozen=True)
class Step:
    """What one decision step gave, for L lanes; lanes that had ended before hold zeros and their last observation."""

    observation: NDArray[np.float32]
    """True next observation `[L, d]` in the task's layout, metres and radians."""
    reward_terms: NDArray[np.float32]
    """Reward `[L, M + 2]` by term: goal, missile 1..M, time; masked missiles are 0 (Eq. 9-11)."""
    terminated: NDArray[np.bool_]
    """`[L]` exit, shot down, or left the battlefield."""
    truncated: NDArray[np.bool_]
    """`[L]` the step limit was reached (no terminal state, so learners bootstrap through it), or a void episode."""

    @property
    def reward(self) -> NDArray[np.float32]:
        """Sum of the terms `[L]` (Eq. 9)."""
        return self.reward_terms.sum(axis=1)


class World:
    """L lanes of a task. `reset` starts lanes, `step` moves all that still fly; ended lanes stay as they are.

    All missiles are part of every world; a masked one is never fired. So what tasks share moves alike, Eq. (8), until
    the interceptor of one of them runs out of missiles.

    Args:
        task: what flies, and which missiles are masked.
        lanes: number of engagements L stepped together.
        seed: with an episode number it fixes the initial state, whatever the mask and whatever the lane.
        device: Warp device, `"cpu"` or for example `"cuda:0"`.
        threads: threads that share the lanes on the CPU; flights do not depend on it, bit for bit.
    """

    def __init__(self, task: Task, lanes: int, seed: int = 0, device: str = "cpu", threads: int = 1) -> None:
        start_warp()
        self.task, self.lanes, self.seed, self.device = task, lanes, seed, device
        self._groups = -(-lanes // WIDTH)
        self.threads = max(1, min(threads, self._groups)) if device == "cpu" else 1
        self._pool = ThreadPoolExecutor(self.threads) if self.threads > 1 else None
        self.next_episode = 0
        """Number of the next episode that `reset` starts of its own accord; to be kept beside `state`."""
        self._views: dict[int, NDArray] = {}
        self._model = kernel_model(task.scenario)
        self._state = kernel_state(task, self._groups, device)
        missiles, rows = task.scenario.launch.missiles, self._groups * WIDTH
        kept = [7 + 2 * (m - 1) + c for m in task.missiles for c in (0, 1)]
        self._columns = slice(None) if len(kept) == 2 * missiles else np.array([*range(7), *kept], dtype=np.intp)
        # Warp's stubs leave the element type of `numpy()` open, hence Any.
        self._action: Any = wp.zeros(self._groups, dtype=Row, device=device)
        self._terms: Any = wp.zeros((rows, missiles + 2), dtype=float, device=device)
        self._observation: Any = wp.zeros((rows, 7 + 2 * missiles), dtype=float, device=device)
        self._flown: Any = wp.zeros(self._groups, dtype=IntRow, device=device)
        self._start: Any = wp.zeros((rows, 10 + 6 * missiles), dtype=float, device=device)
        self._chosen: Any = wp.zeros(rows, dtype=int, device=device)
        self._trace: Any = wp.zeros((1, 1, 1), dtype=float, device=device)
        self._tracing = 0
        self._turns = np.zeros(rows, dtype=np.float32)
        # Lanes that fill up the last group never fly.
        self._write("outcome", np.full(rows, Outcome.TIMEOUT, dtype=np.int32))
        self._episode = np.zeros(lanes, dtype=np.int64)
        self._shares = self._record()
        self.reset()

    def trace(self) -> None:
        """Record every substep from now on; `traced` then returns the rows of the last step."""
        width = 2 * TRACE_AIRCRAFT + TRACE_MISSILE * self.task.scenario.launch.missiles
        shape = (self._groups * WIDTH, self.task.scenario.rules.substeps, width)
        self._trace, self._tracing = wp.zeros(shape, dtype=float, device=self.device), 1
        self._views.clear()
        self._shares = self._record()

    def snapshot(self, lane: int) -> NDArray[np.float32]:
        """The present state as one row `[1, 14 + 8 M]` of a trace; before the first launch only aircraft matter."""
        bodies = self.aircraft
        parts = (bodies["position"][lane], *(bodies[name][lane] for name in ("speed", "climb", "heading", "bank")))
        rows = [np.hstack([part[side] for part in parts]) for side in (0, 1)]
        idle = np.zeros(TRACE_MISSILE * self.task.scenario.launch.missiles)
        return np.concatenate([*rows, idle]).astype(np.float32)[None]

    def traced(self, lane: int) -> NDArray[np.float32]:
        """Substeps of the last decision step `[n, 14 + 8 M]`; see `sim.kernel.readout.write_trace` for the columns."""
        return self._host(self._trace)[lane, : self._host(self._flown).ravel()[lane]].copy()

    def reset(
        self, lanes: ArrayLike | None = None, episodes: ArrayLike | None = None, states: ArrayLike | None = None
    ) -> NDArray[np.float32]:
        """Start lanes (all by default) anew and return the observation of every lane `[L, d]`.

        Args:
            lanes: lane numbers, or a boolean mask `[L]`.
            episodes: episode number of each such lane; the next unused numbers by default.
            states: initial states to use instead of the episodes' own, columns as in `sim.start.initial_states`.
        """
        chosen = np.arange(self.lanes) if lanes is None else np.asarray(lanes)
        if chosen.dtype == bool:
            chosen = np.flatnonzero(chosen)
        if len(chosen):
            numbers = self._number(len(chosen)) if episodes is None else np.asarray(episodes)
            rows = initial_states(self.task.scenario, self.seed, numbers) if states is None else np.asarray(states)
            self._episode[chosen] = numbers
            self._begin(chosen, rows)
        return self.observation

    def step(self, actions: ArrayLike) -> Step:
        """Fly one decision step with turning angles `[L]` or `[L, 1]` [rad], clipped to [-pi/2, pi/2].

        Raises:
            ActionError: an angle is not finite; nothing has moved then.
        """
        self._turns[: self.lanes] = np.asarray(actions, dtype=np.float32).reshape(self.lanes)
        if not np.isfinite(self._turns).all():
            lane = int(np.flatnonzero(~np.isfinite(self._turns))[0])
            raise ActionError(
                f"the action of lane {lane} is {self._turns[lane]}; legal is a finite turning angle in radians"
            )
        if self.device == "cpu":
            self._host(self._action).ravel()[:] = self._turns
        else:
            self._action.assign(self._turns.reshape(-1, WIDTH))
        before = self.outcome
        self._launch_step()
        outcome = self.outcome
        ended = (before == Outcome.FLYING) & (outcome != Outcome.FLYING)
        truncated = ended & ((outcome == Outcome.TIMEOUT) | (outcome == Outcome.NOT_FINITE))
        return Step(self.observation, self._host(self._terms)[: self.lanes].copy(), ended & ~truncated, truncated)

    @property
    def observation(self) -> NDArray[np.float32]:
        """Current observation `[L, d]` in the task's layout (a copy), as the evader's sensors give it."""
        truth = self._host(self._observation)[: self.lanes, self._columns].copy()
        sensor = self.task.scenario.sensor
        if sensor == Sensor():
            return truth
        age_s = self.missiles["age"][:, [m - 1 for m in self.task.missiles]]
        return sense(sensor, self.seed, self._episode, self.steps, age_s, truth)

    @property
    def outcome(self) -> NDArray[np.int32]:
        """`Outcome` of every lane `[L]`."""
        return self._lanes(self._state.outcome)

    @property
    def killer(self) -> NDArray[np.int32]:
        """Number of the missile that shot the evader down, else 0, `[L]`."""
        return self._lanes(self._state.killer)

    @property
    def fate(self) -> NDArray[np.int32]:
        """`Fate` of missiles 1..M of every lane `[L, M]`."""
        return self._lanes(self._state.fate)

    @property
    def steps(self) -> NDArray[np.int32]:
        """Decision steps flown in the current episode `[L]`."""
        return self._lanes(self._state.steps)

    @property
    def closest(self) -> NDArray[np.float32]:
        """Smallest distance so far of every missile `[L, M]` [m]; infinite before its launch."""
        return self.missiles["closest"]

    @property
    def aircraft(self) -> dict[str, NDArray[np.float32]]:
        """Evader and interceptor: position, velocity `[L, 2, 3]`; speed, angles, held altitude and speed `[L, 2]`."""
        rows = self._lanes(self._state.aircraft)
        scalars = {"speed": SPEED, "climb": CLIMB, "heading": HEADING, "bank": BANK}
        scalars |= {"held_altitude": LEVEL, "held_speed": CRUISE}
        return _vectors(rows, position=X, velocity=VX) | {name: rows[..., row] for name, row in scalars.items()}

    @property
    def missiles(self) -> dict[str, NDArray[np.float32]]:
        """Missiles 1..M: position, velocity, lateral `[L, M, 3]`, age and closest `[L, M]`."""
        rows = self._lanes(self._state.missile)
        vectors = _vectors(rows, position=X, velocity=VX, lateral=AX)
        return vectors | {"age": rows[..., AGE], "closest": rows[..., CLOSEST]}

    @property
    def bytes(self) -> int:
        """Memory of all arrays of this world [bytes]."""
        values = [*vars(self).values(), *vars(self._state).values()]
        return sum(value.capacity for value in values if isinstance(value, wp.array))

    def state(self) -> dict[str, NDArray]:
        """Everything that changes during an episode, by array name with a leading axis of lanes; see `restore`."""
        names = [name for name in vars(self._state) if not name.startswith("_") and name not in SHARED]
        return {name: self._lanes(getattr(self._state, name)) for name in names} | {"episode": self._episode.copy()}

    def restore(self, state: dict[str, NDArray]) -> NDArray[np.float32]:
        """Put lanes into states `[L, ...]` that `state` gave, of this or another world of the task; the observation."""
        self._episode[: len(state["episode"])] = state["episode"]
        for name in state.keys() - {"episode"}:
            self._write(name, state[name])
        nobody = wp.zeros(self._groups * WIDTH, dtype=int, device=self.device)
        self._reset_groups(np.arange(self._groups), nobody)
        return self.observation

    def _begin(self, chosen: NDArray[np.integer], rows: NDArray) -> None:
        start, flags = self._host(self._start), self._host(self._chosen)  # on the CPU these are the arrays themselves
        flags[:] = 0
        start[chosen], flags[chosen] = rows, 1
        if self.device != "cpu":
            self._start.assign(start)
            self._chosen.assign(flags)
        self._reset_groups(np.unique(chosen // WIDTH), self._chosen)

    def _reset_groups(self, groups: NDArray[np.integer], chosen: Any) -> None:
        ids = wp.array(groups.astype(np.int32), dtype=int, device=self.device)
        arguments = [self._model, self._state, ids, chosen, self._start, self._observation]
        wp.launch(reset_groups, dim=len(groups), inputs=arguments, device=self.device)

    def _launch_step(self) -> None:
        if self._pool is None:
            self._shares[0].launch()
            return
        # A launch on the CPU releases Python's lock, so shares fly at the same time.
        list(self._pool.map(lambda share: share.launch(), self._shares))

    def _record(self) -> list[Any]:
        """The kernel's launches for the shares of the threads, packed once: packing takes as long as 20 lanes fly."""
        bounds = [self._groups * n // self.threads for n in range(self.threads + 1)]
        arguments = [self._model, self._state, self._action, self._terms, self._observation, self._flown]
        return [
            wp.launch(step_groups, end - first, [first, *arguments, self._trace, self._tracing],
                      device=self.device, record_cmd=True)
            for first, end in itertools.pairwise(bounds)
        ]  # fmt: skip

    def _lanes(self, array: Any) -> NDArray:
        """A kernel array `[groups, ..., WIDTH]` with lanes first `[L, ...]` (a copy)."""
        values = self._host(array)
        if values.ndim == 2:
            return values.reshape(-1)[: self.lanes].copy()
        values = np.moveaxis(values, -1, 1)
        return values.reshape(-1, *values.shape[2:])[: self.lanes].copy()

    def _host(self, array: Any) -> NDArray:
        """The values of a kernel array: on the CPU the array itself, looked up once; else a copy."""
        if self.device != "cpu":
            return array.numpy()
        if array.ptr not in self._views:
            self._views[array.ptr] = array.numpy()
        return self._views[array.ptr]

    def _write(self, name: str, values: NDArray) -> None:
        array = getattr(self._state, name)
        grouped = np.moveaxis(array.numpy(), -1, 1).copy()
        flat = grouped.reshape(-1, *grouped.shape[2:])
        flat[: len(values)] = values
        array.assign(np.moveaxis(grouped, 1, -1))

    def _number(self, count: int) -> NDArray[np.int64]:
        first, self.next_episode = self.next_episode, self.next_episode + count
        return np.arange(first, first + count)


def _vectors(rows: NDArray, **first: int) -> dict[str, NDArray]:
    """Vectors `[..., 3]` by name, out of three rows each from a first one on."""
    return {name: rows[..., row : row + 3] for name, row in first.items()}
