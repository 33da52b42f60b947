"""Episodes flown side by side, each exactly once, and what came of every one."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from agents.policy import Act
from agents.task import GOAL_REACHED, SUBTASK_SOLVED, BoolArray, FloatArray, IntArray, TaskWorld

Progress = Callable[[int, int], None]
"""Called with (episodes done, episodes in all)."""


@dataclass(frozen=True)
class EpisodeResults:
    """How every episode of an evaluation went; arrays over N episodes, by episode number."""

    episode: IntArray
    """Episode numbers: with the seed they fix the initial states."""
    outcome: IntArray
    """Ways the episodes ended."""
    killer: IntArray
    """Subtask that ended each episode, 0 for none."""
    episode_return: FloatArray
    """Sum of the rewards."""
    steps: IntArray
    """Decision steps flown."""
    solved: IntArray
    """Subtasks solved (missiles evaded)."""
    closest_m: FloatArray
    """Smallest distance of any missile [m]; infinite where none was launched, or the domain knows no distance."""

    @property
    def success(self) -> BoolArray:
        """Whether each episode reached the final goal `[N]`."""
        return self.outcome == GOAL_REACHED


def fly_episodes(
    act: Act, world: TaskWorld, first_episode: int, episodes: int, progress: Progress | None = None
) -> EpisodeResults:
    """Fly exactly these episodes, each once, refilling lanes as they finish.

    Every episode counts, short or long: stopping after the first N to finish would favour short flights.
    """
    record = _Record(first_episode, episodes)
    lane_episode = np.arange(world.lanes)
    lane_return = np.zeros(world.lanes)
    observation = world.reset(episodes=first_episode + lane_episode)
    started = world.lanes
    active = np.ones(world.lanes, bool)
    actions = np.zeros((world.lanes, 1), np.float32)
    while active.any():
        actions[active] = act(observation[active])
        step = world.step(actions)
        observation = step.observation
        lane_return += step.reward
        over = active & (step.terminated | step.truncated)
        if not over.any():
            continue
        record.finish(lane_episode[over], over, world, lane_return)
        lanes = np.flatnonzero(over)
        refilled, idle = np.split(lanes, [min(len(lanes), episodes - started)])
        active[idle] = False
        if len(refilled):
            lane_episode[refilled] = started + np.arange(len(refilled))
            started += len(refilled)
            lane_return[refilled] = 0.0
            observation = world.reset(lanes=refilled, episodes=first_episode + lane_episode[refilled])
        if progress is not None:
            progress(record.done, episodes)
    return record.results


def fly_in_parts(
    act: Act, worlds: Sequence[TaskWorld], first_episode: int, parts: Sequence[int], progress: Progress | None = None
) -> EpisodeResults:
    """The same episodes, in consecutive parts of so many, each in a world and a thread of its own.

    An episode is the same in any company, so the results are too. Products and kernels release Python's lock.
    """
    if len(parts) == 1:
        return fly_episodes(act, worlds[0], first_episode, parts[0], progress)
    done, lock = [0] * len(parts), threading.Lock()

    def fly_part(part: int) -> EpisodeResults:
        def tell(count: int, _total: int) -> None:
            with lock:
                done[part] = count
                if progress is not None:
                    progress(sum(done), sum(parts))

        first = first_episode + sum(parts[:part])
        return fly_episodes(act, worlds[part], first, parts[part], tell)

    with ThreadPoolExecutor(len(parts)) as pool:
        flown = list(pool.map(fly_part, range(len(parts))))
    names = [one.name for one in dataclasses.fields(EpisodeResults)]
    return EpisodeResults(**{name: np.concatenate([getattr(part, name) for part in flown]) for name in names})


class _Record:
    """Collects finished episodes by their number."""

    def __init__(self, first_episode: int, episodes: int) -> None:
        whole = {name: np.zeros(episodes, np.int64) for name in ("outcome", "killer", "steps", "solved")}
        numbers = first_episode + np.arange(episodes)
        returns, closest_m = np.zeros(episodes, np.float32), np.full(episodes, np.inf, np.float32)
        self.results = EpisodeResults(episode=numbers, episode_return=returns, closest_m=closest_m, **whole)
        self.done = 0

    def finish(self, index: IntArray, over: BoolArray, world: TaskWorld, lane_return: FloatArray) -> None:
        self.done += len(index)
        self.results.outcome[index] = world.outcome[over]
        self.results.killer[index] = world.killer[over]
        self.results.steps[index] = world.steps[over]
        self.results.solved[index] = (world.fate[over] == SUBTASK_SOLVED).sum(axis=1)
        self.results.episode_return[index] = lane_return[over]
        closest = getattr(world, "closest", None)  # of a domain in which a subtask is something that comes near
        if closest is not None:
            self.results.closest_m[index] = closest[over].min(axis=1)
