"""A third, tiny domain: nothing can be done, an episode ends after a fixed number of steps, by either kind of end.

Its observation is (episode number, step number), so that a stored transition tells where it came from.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from agents.features import ObservationFeatures
from tests.agents.point_robot import NOT_SENSED, PointRobot, RobotStep


@dataclass(frozen=True)
class ClockLayout:
    names: tuple[str, ...] = ("x", "y")
    size: int = 2
    digest: str = "clock"

    def block(self, subtask: int) -> slice:
        raise ValueError(subtask)

    def shared_columns(self, source: ClockLayout) -> np.ndarray:
        return np.arange(2)

    def masked_columns(self, source: ClockLayout) -> np.ndarray:
        return np.arange(0)


@dataclass(frozen=True)
class ClockTask:
    name: str = "clock"
    layout: ClockLayout = ClockLayout()

    def mask(self, subtasks: object) -> ClockTask:
        return self


class ClockWorld:
    def __init__(self, lanes: int, limit: int, terminates: bool) -> None:
        self.lanes, self.limit, self.terminates = lanes, limit, terminates
        self.outcome = np.zeros(lanes, int)
        self.killer = np.zeros(lanes, int)
        self.fate = np.zeros((lanes, 1), int)
        self.steps = np.zeros(lanes, int)
        self.episode = np.zeros(lanes, int)
        self.next_episode = 0
        self.reset()
        self.steps += np.arange(lanes) % limit  # lanes end at different times

    def reset(self, lanes: np.ndarray | None = None, episodes: np.ndarray | None = None) -> np.ndarray:
        lanes = np.arange(self.lanes) if lanes is None else lanes
        self.episode[lanes] = self.next_episode + np.arange(len(lanes))
        self.next_episode += len(lanes)
        self.steps[lanes], self.outcome[lanes] = 0, 0
        return self.observe()

    def step(self, actions: np.ndarray) -> RobotStep:
        self.steps += 1
        over = self.steps >= self.limit
        self.outcome[over] = 1 if self.terminates else 4
        ends = over if self.terminates else np.zeros_like(over)
        return RobotStep(self.observe(), np.ones((self.lanes, 1), np.float32), ends, over & ~ends)

    def state(self) -> dict[str, np.ndarray]:
        return {name: getattr(self, name).copy() for name in ("outcome", "steps", "episode")}

    def restore(self, state: dict[str, np.ndarray]) -> np.ndarray:
        for name, values in state.items():
            getattr(self, name)[:] = values
        return self.observe()

    def observe(self) -> np.ndarray:
        return np.stack((self.episode, self.steps), axis=1).astype(np.float32)


class Clock(PointRobot):
    """The clock as a domain; `scale` divides both numbers, a large one hides them from the networks."""

    def __init__(self, limit: int = 8, terminates: bool = False, scale: float = 1.0) -> None:
        self.limit, self.terminates, self.scale = limit, terminates, scale

    def subtasks(self, task: ClockTask) -> tuple[int, ...]:
        return (1,)

    def masked(self, task: ClockTask) -> tuple[int, ...]:
        return ()

    def world(self, task: ClockTask, lanes: int, seed: int) -> ClockWorld:
        return ClockWorld(lanes, self.limit, self.terminates)

    def features(self, layout: ClockLayout) -> ObservationFeatures:
        return ObservationFeatures(layout, (), {"x": self.scale, "y": self.scale}, NOT_SENSED)
