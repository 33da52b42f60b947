"""Snapshots of a stage that is being learned, and back to the very state they were taken of."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from agents.arrays import Arrays, below, joined
from agents.evaluation import Evaluation
from agents.numerics import matmul_route
from agents.policy import NetworkPolicy, Policy
from agents.snapshot import Snapshot, SnapshotError, policy_arrays, policy_from, policy_values
from agents.stage import Stage
from agents.training_state import FinishedEpisode, TrainingState, start_stage

COUNTERS = ("epoch", "env_steps", "evaluated_episodes", "alpha", "epsilon", "beta")
LANES = ("observation", "features", "reused", "noise", "restarted", "lane_return")


def take_snapshot(stage: Stage, state: TrainingState) -> Snapshot:
    """The training as it stands after an epoch. The replay is not copied: read it before learning goes on."""
    parts = {"learner": state.learner.arrays(), "world": state.world.state()}
    lanes = {name: np.array(getattr(state, name)) for name in LANES}
    values = {"generator": state.generator.bit_generator.state, "next_episode": state.world.next_episode}
    return Snapshot(
        stage.index,
        common_values(stage, state) | values,
        common_arrays(stage, state) | joined(parts) | lanes,
        state.replay,
    )


def resume_stage(stage: Stage, snapshot: Snapshot) -> TrainingState:
    """The state that a snapshot was taken of.

    Raises:
        SnapshotError: it was taken of another training or by another version.
    """
    state = start_stage(stage)
    with_reason(stage, snapshot, lambda: _restore(stage, state, snapshot))
    return state


def with_reason(stage: Stage, snapshot: Snapshot, restore: Callable[[], None]) -> None:
    """Check that a snapshot is of this stage and restore from it; whatever does not fit becomes a sentence."""
    scenario, digest = stage.domain.scenario(stage.task)
    if (kept := snapshot.values.get("task")) != stage.task.name:
        raise SnapshotError(f"the checkpoint is of task {kept}, and the training has {stage.task.name} in that place")
    if snapshot.values.get("scenario_digest") != digest:
        raise SnapshotError(f"scenario '{scenario}' has changed since the checkpoint; train anew")
    try:
        restore()
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, RuntimeError) as error:
        text = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise SnapshotError(f"the checkpoint of {stage.task.name} does not fit this version: {text}") from error


def _restore(stage: Stage, state: TrainingState, snapshot: Snapshot) -> None:
    values, arrays = snapshot.values, snapshot.arrays
    restore_common(stage, state, snapshot)
    state.learner.restore(below("learner", arrays))
    if snapshot.slots is not None:
        state.replay.restore(snapshot.slots)
    state.world.restore(below("world", arrays))
    state.world.next_episode = values["next_episode"]
    state.generator.bit_generator.state = values["generator"]
    for name in LANES:
        now = getattr(state, name)
        if arrays[name].shape != now.shape or arrays[name].dtype != now.dtype:
            raise ValueError(f"{name} is {arrays[name].dtype} {list(arrays[name].shape)}")
        setattr(state, name, np.array(arrays[name]))


def common_values(stage: Stage, state: TrainingState) -> dict[str, Any]:
    """What every kind of learner has to remember, as JSON values."""
    finished = [(one.success, one.episode_return, one.steps) for one in state.finished]
    return {
        **{name: getattr(state, name) for name in COUNTERS},
        "task": stage.task.name,
        "route": matmul_route(),
        "hyper": dataclasses.asdict(stage.hyper),
        "scenario_digest": stage.domain.scenario(stage.task)[1],
        "passes": state.passes,
        "finished": finished,
        "evaluation": state.evaluation and state.evaluation.to_json(),
        "best_evaluation": state.best_evaluation and state.best_evaluation.to_json(),
        "best": state.best and policy_values(state.best),
        "wall_s": time.perf_counter() - state.started,
        "cpu_s": time.process_time() - state.cpu_started,
        **_guide_values(stage.guide),
    }


def common_arrays(stage: Stage, state: TrainingState) -> Arrays:
    """The weights of the best policy and of a guide that is a network."""
    parts = {"best": policy_arrays(state.best) if state.best else {}}
    if isinstance(stage.guide, NetworkPolicy):
        parts["guide"] = policy_arrays(stage.guide)
    return joined(parts)


def restore_common(stage: Stage, state: TrainingState, snapshot: Snapshot) -> None:
    """Inverse of `common_values` and `common_arrays`, but for the guide, which is part of the stage."""
    values = snapshot.values
    for name in COUNTERS:
        setattr(state, name, values[name])
    state.passes = tuple(values["passes"])
    state.finished.extend(FinishedEpisode(*one) for one in values["finished"])
    state.evaluation = evaluation_from(values["evaluation"])
    state.best_evaluation = evaluation_from(values["best_evaluation"])
    if values["best"] is not None:
        state.best = policy_from(values["best"], below("best", snapshot.arrays), stage.domain)
    state.started = time.perf_counter() - values["wall_s"]
    state.cpu_started = time.process_time() - values["cpu_s"]


def _guide_values(guide: Policy) -> dict[str, Any]:
    if isinstance(guide, NetworkPolicy):
        return {"guide": policy_values(guide)}
    generator = getattr(guide, "generator", None)
    return {"guide_generator": generator.bit_generator.state} if isinstance(generator, np.random.Generator) else {}


def evaluation_from(values: Mapping[str, Any] | None) -> Evaluation | None:
    """Inverse of `Evaluation.to_json`."""
    if values is None:
        return None
    tuples = {name: tuple(values[name]) for name in ("mask", "missiles", "success_ci95")}
    return Evaluation(**{**values, **tuples})
