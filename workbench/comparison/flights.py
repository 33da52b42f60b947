"""What a worker of comparisons does: count engagements, map shots, record a few engagements from above."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from agents.envelope import Envelope, envelope
from agents.envelope_axis import Axis
from agents.evaluation import evaluate
from agents.policy import Act, Policy, bind
from agents.task import FloatArray
from sim.scenario import Scenario
from sim.task import Task
from sim.world import Fate, Outcome, World
from workbench.comparison.cache import evaluation_to_json
from workbench.comparison.closely import repeatable
from workbench.comparison.work import ComparisonError, Work
from workbench.launcher import cpu_count
from workbench.policies import resolve_policy
from workbench.runs import RunStore

Tell = Callable[[float], None]
"""Called with the share that is done, 0 to 1."""
USUAL_SHARE = 0.75
"""Usual length of an engagement as a share of the step limit, for the progress bar alone."""
NEARLY = 0.99
PARTS = 4
"""An evaluation is flown by so many threads at most: what people wait for is one long one, not many."""
RANGES, ASPECTS = 30, 48
"""Cells of a map of survival, outwards and around."""
NEAREST_M, BEYOND = 2e3, 1.0
"""Its first range, and its last one as a multiple of the scenario's launch range."""
TRACK_STEPS = 8
"""A track on a small picture has a point every so many decision steps."""


def do(work: Work, runs: Path, tell: Tell) -> dict[str, Any]:
    """Do a piece of work; the result as plain JSON values.

    Raises:
        ComparisonError: the policy or the scenario is not any more what was asked for.
        SubMasError: the policy or the scenario cannot be read, or the policy cannot see a missile.
    """
    from workbench.comparison.policies import policy_digest

    store, task = RunStore(runs), work.task
    if task.scenario.digest != work.scenario_digest or policy_digest(work.policy, store) != work.policy_digest:
        raise ComparisonError(f"{work.policy} or its scenario has changed in the meantime; fly again")
    policy = resolve_policy(work.policy, store)
    if work.kind == "evaluation":
        watched = Watched(policy, work.episodes * USUAL_SHARE * task.scenario.rules.max_steps, tell)
        threads = min(cpu_count(), PARTS) if repeatable(work.policy) else 1
        flown = evaluate(watched, task, work.episodes, work.seed, progress=watched.count, threads=threads)
        return evaluation_to_json(flown)
    if work.kind == "survival":
        return survival(policy, task, work.seed, tell).to_json()
    return {"tracks": tracks(task, bind(policy, task), work.seed, work.numbers)}


class Watched:
    """A policy that tells how far its evaluation has come: the evaluator itself only tells of finished episodes."""

    def __init__(self, policy: Policy, usual_steps: float, tell: Tell) -> None:
        self._policy, self._usual, self._tell = policy, usual_steps, tell
        self._flown, self._finished = 0, 0.0
        self._lock = threading.Lock()
        self.name, self.layout = policy.name, policy.layout

    def act(self, observation: FloatArray, layout: Any) -> FloatArray:
        """What the policy does."""
        with self._lock:
            self._flown += len(observation)
            self._tell(min(max(self._flown / self._usual, self._finished), NEARLY))
        return self._policy.act(observation, layout)

    def count(self, done: int, total: int) -> None:
        """Episodes that are over."""
        self._finished = done / total


def survival(policy: Policy, task: Task, seed: int, tell: Tell) -> Envelope:
    """Where the policy survives one missile fired at once, over launch range and aspect all around."""
    return envelope(
        policy, task.scenario, *survival_axes(task.scenario), masked=task.masked, seed=seed,
        progress=lambda done, total: tell(done / total),
    )  # fmt: skip


def survival_axes(scenario: Scenario) -> tuple[Axis, Axis]:
    """Launch range [m] to beyond the scenario's own, and aspect [deg] once around."""
    furthest_m = 1e3 * round(BEYOND * scenario.launch.range_m / 1e3)
    ranges = np.linspace(min(NEAREST_M, furthest_m / 2.0), furthest_m, RANGES).round()
    around = -180.0 + 360.0 / ASPECTS * np.arange(ASPECTS)
    return Axis("launch_range_m", tuple(ranges.tolist())), Axis("aspect_deg", tuple(around.tolist()))


def tracks(task: Task, act: Act, seed: int, episodes: Sequence[int]) -> list[dict[str, Any]]:
    """Engagements seen from above: how each ended, and where everything flew [km]."""
    world = World(task, len(episodes), seed)
    observation = world.reset(episodes=episodes)
    places, active = [_places(world)], np.ones(world.lanes, bool)
    actions = np.zeros((world.lanes, 1), np.float32)
    while active.any():
        actions[active] = act(observation[active])
        observation = world.step(actions).observation
        active = world.outcome == Outcome.FLYING
        places.append(_places(world))
    return [_track(world, lane, int(episode), np.stack(places)) for lane, episode in enumerate(episodes)]


def _places(world: World) -> FloatArray:
    """Positions [km] `[L, 2 + M, 2]` of evader, interceptor and missiles; NaN where one is not in flight."""
    missiles = world.missiles["position"][..., :2].copy()
    missiles[world.fate != Fate.FLYING] = np.nan
    return np.concatenate([world.aircraft["position"][..., :2], missiles], axis=1) / np.float32(1e3)


def _track(world: World, lane: int, episode: int, places: FloatArray) -> dict[str, Any]:
    steps, step_s = int(world.steps[lane]), world.task.scenario.rules.step_s
    mine = places[: steps + 1, lane]
    closest_m = float(world.closest[lane].min())
    missiles = {
        str(number): {"path": _path(mine[:, 1 + number], 1), "hit": bool(world.fate[lane, number - 1] == Fate.HIT)}
        for number in world.task.missiles
        if np.isfinite(mine[:, 1 + number, 0]).any()
    }
    return {
        "episode": episode, "outcome": Outcome(int(world.outcome[lane])).name.lower(),
        "killer": int(world.killer[lane]), "time_s": steps * step_s, "closest_m": round(closest_m, 2),
        "evader": _path(mine[:, 0], TRACK_STEPS), "interceptor": _path(mine[:, 1], TRACK_STEPS), "missiles": missiles,
    }  # fmt: skip


def _path(points: FloatArray, every: int) -> list[list[float]]:
    """Points in flight [km], thinned, the first and the last among them."""
    flown = points[np.isfinite(points[:, 0])]
    kept = [*range(0, len(flown) - 1, every), len(flown) - 1]
    return [[round(float(x), 2), round(float(y), 2)] for x, y in flown[kept]]
