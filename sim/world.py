"""The world: many lanes of one task stepped together, one decision step a call, without automatic resets."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import ArrayLike, NDArray

from sim.device import start_warp
from sim.kernel import reset_lanes, step_lanes
from sim.model import kernel_model, kernel_state
from sim.start import initial_states
from sim.task import Task

TRACE_AIRCRAFT = 7
TRACE_MISSILE = 8


class Outcome(IntEnum):
    """How an episode stands or ended."""

    FLYING = 0
    EXIT = 1
    SHOT_DOWN = 2
    LEFT_FIELD = 3
    TIMEOUT = 4


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
    """`[L]` the step limit was reached: no terminal state, so learners bootstrap through it."""

    @property
    def reward(self) -> NDArray[np.float32]:
        """Sum of the terms `[L]` (Eq. 9)."""
        return self.reward_terms.sum(axis=1)


class World:
    """L lanes of a task. `reset` starts lanes, `step` moves all that still fly; ended lanes stay as they are.

    All missiles are part of every world; a masked one is never fired. So what tasks share moves alike, Eq. (8), until
    the missile that one of them lacks leaves the interceptor.

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
        self.threads = max(1, min(threads, lanes)) if device == "cpu" else 1
        self._pool = ThreadPoolExecutor(self.threads) if self.threads > 1 else None
        self._next_episode = 0
        self._model = kernel_model(task.scenario)
        self._state = kernel_state(task, lanes, device)
        missiles = task.scenario.launch.missiles
        kept = [7 + 2 * (m - 1) + c for m in task.missiles for c in (0, 1)]
        self._columns = np.array([*range(7), *kept], dtype=np.intp)
        # Warp's stubs leave the element type of `numpy()` open, hence Any.
        self._action = wp.zeros(lanes, dtype=float, device=device)
        self._terms: Any = wp.zeros((lanes, missiles + 2), dtype=float, device=device)
        self._observation: Any = wp.zeros((lanes, 7 + 2 * missiles), dtype=float, device=device)
        self._flown = wp.zeros(lanes, dtype=int, device=device)
        self._trace: Any = wp.zeros((1, 1, 1), dtype=float, device=device)
        self._tracing = 0
        self.reset()

    def trace(self) -> None:
        """Record every substep from now on; `traced` then returns the rows of the last step."""
        width = 2 * TRACE_AIRCRAFT + TRACE_MISSILE * self.task.scenario.launch.missiles
        shape = (self.lanes, self.task.scenario.rules.substeps, width)
        self._trace, self._tracing = wp.zeros(shape, dtype=float, device=self.device), 1

    def snapshot(self, lane: int) -> NDArray[np.float32]:
        """The present state as one row `[1, 14 + 8 M]` of a trace; before the first launch only aircraft matter."""
        aircraft = self._state.aircraft.numpy()[lane]
        rows = [np.concatenate([a["position"], [a["speed"], a["climb"], a["heading"], a["bank"]]]) for a in aircraft]
        idle = np.zeros(TRACE_MISSILE * self.task.scenario.launch.missiles)
        return np.concatenate([*rows, idle]).astype(np.float32)[None]

    def traced(self, lane: int) -> NDArray[np.float32]:
        """Substeps of the last decision step `[n, 14 + 8 M]`; see `kernel.write_trace` for the columns."""
        return self._trace.numpy()[lane, : self._flown.numpy()[lane]].copy()

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
            start = wp.array(rows.astype(np.float32), dtype=float, device=self.device)
            ids = wp.array(chosen.astype(np.int32), dtype=int, device=self.device)
            arguments = [self._model, self._state, ids, start, self._observation]
            wp.launch(reset_lanes, dim=len(chosen), inputs=arguments, device=self.device)
        return self.observation

    def step(self, actions: ArrayLike) -> Step:
        """Fly one decision step with turning angles `[L]` or `[L, 1]` [rad], clipped to [-pi/2, pi/2]."""
        self._action.assign(np.asarray(actions, dtype=np.float32).reshape(self.lanes))
        self._launch_step()
        outcome, flew = self.outcome, self._flown.numpy() > 0
        ended = flew & (outcome != Outcome.FLYING)
        truncated = ended & (outcome == Outcome.TIMEOUT)
        return Step(self.observation, self._terms.numpy().copy(), ended & ~truncated, truncated)

    @property
    def observation(self) -> NDArray[np.float32]:
        """Current observation `[L, d]` in the task's layout (a copy)."""
        return self._observation.numpy()[:, self._columns]

    @property
    def outcome(self) -> NDArray[np.int32]:
        """`Outcome` of every lane `[L]`."""
        return self._state.outcome.numpy().copy()

    @property
    def killer(self) -> NDArray[np.int32]:
        """Number of the missile that shot the evader down, else 0, `[L]`."""
        return self._state.killer.numpy().copy()

    @property
    def fate(self) -> NDArray[np.int32]:
        """`Fate` of missiles 1..M of every lane `[L, M]`."""
        return self._state.fate.numpy().copy()

    @property
    def steps(self) -> NDArray[np.int32]:
        """Decision steps flown in the current episode `[L]`."""
        return self._state.steps.numpy().copy()

    def _launch_step(self) -> None:
        if self._pool is None:
            self._step_share(0, self.lanes)
            return
        bounds = [self.lanes * n // self.threads for n in range(self.threads + 1)]
        # A launch on the CPU releases Python's lock, so shares fly at the same time.
        list(self._pool.map(self._step_share, bounds[:-1], bounds[1:]))

    def _step_share(self, first: int, end: int) -> None:
        arguments = [self._model, self._state, self._action, self._terms, self._observation, self._flown]
        inputs = [first, *arguments, self._trace, self._tracing]
        wp.launch(step_lanes, dim=end - first, inputs=inputs, device=self.device)

    def _number(self, count: int) -> NDArray[np.int64]:
        first, self._next_episode = self._next_episode, self._next_episode + count
        return np.arange(first, first + count)
