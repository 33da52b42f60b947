"""The one evaluator: many episodes flown as lanes, summarised with intervals (Table 4, Fig. 13)."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from agents.policy import Act, Policy, bind
from agents.task import (
    GOAL_REACHED,
    SUBTASK_SOLVED,
    BoolArray,
    Domain,
    FloatArray,
    IntArray,
    SubtaskTask,
    TaskWorld,
)

Progress = Callable[[int, int], None]
"""Called with (episodes done, episodes in all)."""
MAX_LANES = 1024
WILSON_Z = 1.959964
"""Two-sided 95 % quantile of the normal distribution."""


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


@dataclass(frozen=True)
class Evaluation:
    """Figures of one policy on one task; `to_json` is what `workbench evaluate --json` prints."""

    policy: str
    mask: tuple[int, ...]
    missiles: tuple[int, ...]
    scenario: str
    episodes: int
    seed: int
    success_rate: float
    success_ci95: tuple[float, float]
    """Wilson 95 % interval of the success rate."""
    mean_return: float
    mean_length_s: float
    outcomes: Mapping[str, int]
    """Episodes by the way they ended."""
    missiles_evaded_mean: float
    env_steps_per_s: float
    results: EpisodeResults | None = field(default=None, repr=False, compare=False)
    """Every episode, for figures; not part of the JSON."""

    def to_json(self) -> dict[str, Any]:
        """The figures as plain JSON values, without the single episodes."""
        return {
            "policy": self.policy,
            "mask": list(self.mask),
            "missiles": list(self.missiles),
            "scenario": self.scenario,
            "episodes": self.episodes,
            "seed": self.seed,
            "success_rate": self.success_rate,
            "success_ci95": list(self.success_ci95),
            "mean_return": self.mean_return,
            "mean_length_s": self.mean_length_s,
            "outcomes": dict(self.outcomes),
            "missiles_evaded_mean": self.missiles_evaded_mean,
            "env_steps_per_s": self.env_steps_per_s,
        }


def evaluate(
    policy: Policy,
    task: SubtaskTask,
    episodes: int,
    seed: int,
    lanes: int | None = None,
    progress: Progress | None = None,
    *,
    domain: Domain | None = None,
    first_episode: int = 0,
) -> Evaluation:
    """Fly a policy on a task and count.

    Args:
        policy: what flies; missing subtasks are shown to it as not detected.
        task: what it flies.
        episodes: how many episodes, numbered from `first_episode`.
        seed: with the episode number it fixes each initial state, for every policy and every mask alike.
        lanes: episodes flown side by side; all of them up to 1024 by default.
        progress: told how many episodes are done.
        domain: where the task comes from; the paper's domain by default.
        first_episode: number of the first episode.

    Raises:
        PolicyError: the policy cannot see a subtask of the task.
        ValueError: no episode is asked for.
    """
    if episodes < 1:
        raise ValueError(f"episodes is {episodes}; evaluate at least 1")
    domain = domain or _evasion()
    act = bind(policy, task)
    world = domain.world(task, min(episodes, lanes or MAX_LANES), seed)
    started = time.perf_counter()
    # Products of these sizes are too small to share: on a machine that does anything else, threads wait for each other.
    with threadpool_limits(limits=1, user_api="blas"):
        results = fly_episodes(act, world, first_episode, episodes, progress)
    elapsed_s = time.perf_counter() - started
    return _summary(policy, task, domain, seed, results, elapsed_s)


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


def wilson_interval(successes: int, trials: int, z: float = WILSON_Z) -> tuple[float, float]:
    """Wilson score interval of a proportion, 95 % by default."""
    share = successes / trials
    centre = (share + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z / (1 + z * z / trials) * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    # At the ends the formula is exact up to rounding: 0 of n starts at 0, n of n ends at 1.
    return (centre - half if successes else 0.0), (centre + half if successes < trials else 1.0)


def pooled(parts: Sequence[Evaluation]) -> Evaluation:
    """One evaluation out of several of the same policy, task and seed, on different episodes."""
    episodes = sum(part.episodes for part in parts)

    def mean(name: str) -> float:
        return sum(getattr(part, name) * part.episodes for part in parts) / episodes

    rate = mean("success_rate")
    return dataclasses.replace(
        parts[0],
        episodes=episodes,
        success_rate=rate,
        success_ci95=wilson_interval(round(rate * episodes), episodes),
        mean_return=mean("mean_return"),
        mean_length_s=mean("mean_length_s"),
        outcomes={name: sum(part.outcomes[name] for part in parts) for name in parts[0].outcomes},
        missiles_evaded_mean=mean("missiles_evaded_mean"),
        results=None,
    )


def _summary(
    policy: Policy, task: SubtaskTask, domain: Domain, seed: int, results: EpisodeResults, elapsed_s: float
) -> Evaluation:
    episodes, successes = len(results.episode), int(results.success.sum())
    return Evaluation(
        policy=policy.name,
        mask=domain.masked(task),
        missiles=domain.subtasks(task),
        scenario=domain.scenario(task)[0],
        episodes=episodes,
        seed=seed,
        success_rate=successes / episodes,
        success_ci95=wilson_interval(successes, episodes),
        mean_return=float(results.episode_return.mean(dtype=np.float64)),
        mean_length_s=float(results.steps.mean()) * domain.step_s(task),
        outcomes={name: int((results.outcome == code).sum()) for code, name in domain.outcome_names.items()},
        missiles_evaded_mean=float(results.solved.mean()),
        env_steps_per_s=float(results.steps.sum()) / max(elapsed_s, 1e-9),
        results=results,
    )


def _evasion() -> Domain:
    # Imported late: the evaluator itself must work for a domain that needs no simulator.
    from agents.evasion import EVASION

    return EVASION
