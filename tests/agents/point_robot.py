"""A second domain: a point robot on a plane must reach a gate past circular obstacles, which can be masked.

It shares no code with the simulator. If the learner solves it, the learner knows nothing of missiles.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from agents.features import ObservationFeatures

OWN = ("x", "y", "psi", "phi_exit")
NOT_SENSED = (-1.0, -math.pi)
OBSTACLES = 2
OBSTACLE_X = (-1.0, 2.5)
GOAL_X, HALF_WIDTH, SPEED, RADIUS, SENSED_WITHIN = 5.0, 2.0, 0.4, 0.6, 2.4
MAX_TURN, MAX_STEPS = 0.6, 60
CHANGING = ("position", "heading", "centre", "outcome", "killer", "fate", "steps")
RUNNING, GOAL, HIT, LOST, TIMEOUT = range(5)


@dataclass(frozen=True)
class RobotLayout:
    obstacles: tuple[int, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return OWN + tuple(f"{kind}_{i}" for i in self.obstacles for kind in ("r", "phi"))

    @property
    def size(self) -> int:
        return len(self.names)

    @property
    def digest(self) -> str:
        return hashlib.sha256(",".join(self.names).encode()).hexdigest()[:12]

    def block(self, obstacle: int) -> slice:
        start = len(OWN) + 2 * self.obstacles.index(obstacle)
        return slice(start, start + 2)

    def shared_columns(self, source: RobotLayout) -> np.ndarray:
        return np.array([self.names.index(name) for name in source.names], int)

    def masked_columns(self, source: RobotLayout) -> np.ndarray:
        return np.array([i for i, name in enumerate(self.names) if name not in source.names], int)


@dataclass(frozen=True)
class RobotTask:
    masked: frozenset[int] = frozenset()

    @property
    def obstacles(self) -> tuple[int, ...]:
        return tuple(i for i in range(1, OBSTACLES + 1) if i not in self.masked)

    @property
    def layout(self) -> RobotLayout:
        return RobotLayout(self.obstacles)

    @property
    def name(self) -> str:
        return f"source-{len(self.masked)}" if self.masked else "target"

    def mask(self, obstacles: Iterable[int]) -> RobotTask:
        return RobotTask(self.masked | frozenset(obstacles))


@dataclass(frozen=True)
class RobotStep:
    observation: np.ndarray
    reward_terms: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray

    @property
    def reward(self) -> np.ndarray:
        return self.reward_terms.sum(axis=1)


class RobotWorld:
    """Obstacles lie on the straight way to the gate, so heading for the gate always hits the first one."""

    def __init__(self, task: RobotTask, lanes: int, seed: int, pay: float = 1.0) -> None:
        self.task, self.lanes, self.seed, self.pay = task, lanes, seed, np.float32(pay)
        self.next_episode = 0
        self.position = np.zeros((lanes, 2))
        self.heading = np.zeros(lanes)
        self.centre = np.zeros((lanes, OBSTACLES, 2))
        self.outcome = np.zeros(lanes, int)
        self.killer = np.zeros(lanes, int)
        self.fate = np.zeros((lanes, OBSTACLES), int)
        self.steps = np.zeros(lanes, int)
        self.reset()

    def reset(self, lanes: np.ndarray | None = None, episodes: np.ndarray | None = None) -> np.ndarray:
        lanes = np.arange(self.lanes) if lanes is None else np.asarray(lanes)
        if episodes is None:
            episodes = self.next_episode + np.arange(len(lanes))
            self.next_episode += len(lanes)
        for lane, episode in zip(lanes, episodes, strict=True):
            generator = np.random.default_rng([self.seed, int(episode)])
            y = generator.uniform(-1.0, 1.0)
            self.position[lane] = (-5.0, y)
            self.heading[lane] = generator.uniform(-0.5, 0.5)
            for index, x in enumerate(OBSTACLE_X):
                on_way = y * (1.0 - (x + 5.0) / 10.0)
                self.centre[lane, index] = (x, on_way + generator.uniform(-0.2, 0.2))
        self.outcome[lanes], self.killer[lanes], self.steps[lanes] = 0, 0, 0
        self.fate[lanes] = 0
        return self._observe()

    def state(self) -> dict[str, np.ndarray]:
        return {name: getattr(self, name).copy() for name in CHANGING}

    def restore(self, state: dict[str, np.ndarray]) -> np.ndarray:
        for name in CHANGING:
            getattr(self, name)[:] = state[name]
        return self._observe()

    def step(self, actions: np.ndarray) -> RobotStep:
        alive = self.outcome == RUNNING
        turn = np.clip(np.asarray(actions, float).reshape(self.lanes), -MAX_TURN, MAX_TURN)
        self.heading = np.where(alive, _wrap(self.heading + turn), self.heading)
        move = SPEED * np.stack((np.cos(self.heading), np.sin(self.heading)), axis=1)
        self.position += np.where(alive[:, None], move, 0.0)
        self.steps += alive
        terms = self.pay * self._reward_terms(alive)
        over = alive & (self.outcome != RUNNING)
        truncated = over & (self.outcome == TIMEOUT)
        return RobotStep(self._observe(), terms, over & ~truncated, truncated)

    def _reward_terms(self, alive: np.ndarray) -> np.ndarray:
        terms = np.zeros((self.lanes, OBSTACLES + 2), np.float32)
        terms[alive, -1] = -0.02
        range_, _ = self._sense()
        for obstacle in self.task.obstacles:
            i = obstacle - 1
            hit = alive & (range_[:, i] < RADIUS) & (self.outcome == RUNNING)
            self.outcome[hit], self.killer[hit] = HIT, obstacle
            terms[hit, obstacle] = -4.0
            passed = alive & (self.fate[:, i] == 0) & (self.position[:, 0] > self.centre[:, i, 0] + 0.3)
            self.fate[passed & ~hit, i] = 2
            # An obstacle passed without ever being sensed pays nothing: Eq. (12) holds by construction.
            terms[passed & ~hit & (range_[:, i] < SENSED_WITHIN - SPEED), obstacle] += 0.5
        x, y = self.position[:, 0], self.position[:, 1]
        goal = alive & (self.outcome == RUNNING) & (x >= GOAL_X) & (np.abs(y) < HALF_WIDTH)
        self.outcome[goal] = GOAL
        terms[goal, 0] = 4.0
        lost = alive & (self.outcome == RUNNING) & ((np.abs(x) > 6.0) | (np.abs(y) > 4.0))
        self.outcome[lost] = LOST
        terms[lost, 0] = -4.0
        self.outcome[alive & (self.outcome == RUNNING) & (self.steps >= MAX_STEPS)] = TIMEOUT
        return terms

    def _sense(self) -> tuple[np.ndarray, np.ndarray]:
        offset = self.centre - self.position[:, None]
        range_ = np.hypot(offset[..., 0], offset[..., 1])
        azimuth = _wrap(np.arctan2(offset[..., 1], offset[..., 0]) - self.heading[:, None])
        return range_, azimuth

    def _observe(self) -> np.ndarray:
        to_exit = np.arctan2(-self.position[:, 1], GOAL_X - self.position[:, 0]) - self.heading
        own = np.stack((self.position[:, 0], self.position[:, 1], self.heading, _wrap(to_exit)), axis=1)
        range_, azimuth = self._sense()
        sensed = (range_ < SENSED_WITHIN) & (self.fate == 0)
        block = np.where(sensed[..., None], np.stack((range_, azimuth), axis=2), NOT_SENSED)
        kept = [i - 1 for i in self.task.obstacles]
        return np.concatenate((own, block[:, kept].reshape(self.lanes, -1)), axis=1).astype(np.float32)


@dataclass(frozen=True)
class PointRobot:
    """The domain, as `agents.task.Domain` describes one."""

    pay: float = 1.0
    """Factor on all rewards; with little pay the guide's example weighs more than what the task pays."""
    action_limit: float = MAX_TURN
    default_block: tuple[float, float] = NOT_SENSED

    @property
    def outcome_names(self) -> dict[int, str]:
        return {GOAL: "exit", HIT: "hit", LOST: "lost", TIMEOUT: "timeout"}

    def layout(self, subtasks: tuple[int, ...]) -> RobotLayout:
        return RobotLayout(subtasks)

    def target(self, scenario: str, subtasks: int) -> RobotTask:
        return RobotTask(frozenset(range(subtasks + 1, OBSTACLES + 1)))

    def subtasks(self, task: RobotTask) -> tuple[int, ...]:
        return task.obstacles

    def masked(self, task: RobotTask) -> tuple[int, ...]:
        return tuple(sorted(task.masked))

    def scenario(self, task: RobotTask) -> tuple[str, str]:
        return "plane", "0" * 12

    def step_s(self, task: RobotTask) -> float:
        return 1.0

    def world(self, task: RobotTask, lanes: int, seed: int) -> RobotWorld:
        return RobotWorld(task, lanes, seed, self.pay)

    def features(self, layout: RobotLayout) -> ObservationFeatures:
        return ObservationFeatures(layout, layout.obstacles, {"x": 5.0, "y": 2.5, "r": 2.5}, NOT_SENSED)


POINT_ROBOT = PointRobot()


def _wrap(angle: np.ndarray) -> np.ndarray:
    return -((math.pi - angle) % (2.0 * math.pi) - math.pi)
