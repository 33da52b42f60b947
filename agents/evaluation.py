"""The one evaluator: many episodes flown as lanes, summarised with intervals (Table 4, Fig. 13)."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from agents.episodes import EpisodeResults, Progress, fly_in_parts
from agents.policy import Policy, bind
from agents.task import Domain, SubtaskTask

MAX_LANES = 1024
WILSON_Z = 1.959964
"""Two-sided 95 % quantile of the normal distribution."""


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
    threads: int = 1,
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
        threads: parts in which the episodes are flown at the same time; a policy that draws needs 1 to repeat itself.

    Raises:
        PolicyError: the policy cannot see a subtask of the task.
        ValueError: no episode is asked for.
    """
    if episodes < 1:
        raise ValueError(f"episodes is {episodes}; evaluate at least 1")
    domain = domain or _evasion()
    act = bind(policy, task)
    shares = [len(share) for share in np.array_split(np.arange(episodes), min(threads, episodes))]
    worlds = [domain.world(task, min(share, lanes or MAX_LANES), seed) for share in shares]
    started = time.perf_counter()
    results = fly_in_parts(act, worlds, first_episode, shares, progress)
    elapsed_s = time.perf_counter() - started
    return _summary(policy, task, domain, seed, results, elapsed_s)


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
