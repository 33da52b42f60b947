"""The baselines of §4.3 (Fig. 9): SAC and PPO learn a task from scratch, and report as a stage of our own learner does.

They get the same epochs, held-out evaluations and rules by which the best policy is kept and a stage ends.
"""

from __future__ import annotations

import dataclasses
import time
from collections import deque
from dataclasses import dataclass, field
from typing import Any, cast

from agents.arrays import below, joined
from agents.baselines_learner import LEARNERS, BaselineLearner
from agents.baselines_world import TaskVecEnv
from agents.card import card_of
from agents.evaluation import Evaluation
from agents.knowledge_transfer import end_reason, finish_stage
from agents.metrics import epoch_row
from agents.policy import NetworkPolicy
from agents.promotion import examine, is_better, policy_name
from agents.recorder import Recorder
from agents.resume import common_arrays, common_values, restore_common, with_reason
from agents.snapshot import Snapshot
from agents.stage import Stage
from agents.training_state import EpochCounts, FinishedEpisode, TrainingState


@dataclass
class BaselineState:
    """What changes in training. Its names are those of `TrainingState`, so that the same functions report on it."""

    learner: BaselineLearner
    env: TaskVecEnv
    finished: deque[FinishedEpisode]
    """Latest training episodes."""
    epoch: int = 0
    env_steps: int = 0
    counts: EpochCounts = field(default_factory=EpochCounts)
    evaluation: Evaluation | None = None
    evaluated_episodes: int = 0
    passes: tuple[float, ...] = ()
    best: NetworkPolicy | None = None
    best_evaluation: Evaluation | None = None
    started: float = field(default_factory=time.perf_counter)
    cpu_started: float = field(default_factory=time.process_time)
    alpha: None = None
    epsilon: None = None
    beta: None = None

    @property
    def reported(self) -> TrainingState:
        """This state for functions that report on a stage; they read no more of one than is here."""
        return cast("TrainingState", self)


def learn_baseline(stage: Stage, recorder: Recorder, snapshot: Snapshot | None = None) -> NetworkPolicy:
    """Train SAC or PPO on the stage's task, without its guide; the best policy by held-out evaluation.

    With a `snapshot` of this stage it goes on from there.
    """
    state = start_baseline(stage)
    if snapshot:
        resume_baseline(stage, state, snapshot)
    else:
        words = f"{stage.task.name} from scratch by {stage.variant.algorithm.upper()} of Stable-Baselines3"
        recorder.event("stage_started", words, task=stage.task.name)
    reason = end_reason(stage, state.reported, recorder) if snapshot else ""
    while not reason:
        run_epoch(stage, state)
        evaluation = evaluate_epoch(stage, state, recorder)
        recorder.epoch(baseline_row(stage, state, evaluation))
        recorder.checkpoint(lambda: take_baseline(stage, state))
        reason = end_reason(stage, state.reported, recorder)
    if state.best is None:
        keep_best(stage, state, recorder)
    return finish_stage(stage, state.reported, recorder, reason)


def start_baseline(stage: Stage) -> BaselineState:
    """Fresh networks and the same lanes and initial states that our own learner starts with."""
    hyper = stage.hyper
    env = TaskVecEnv(stage.domain, stage.task, hyper.lanes, stage.seed, hyper.reward_scale)
    make = LEARNERS[stage.variant.algorithm]
    learner = make(env, hyper, stage.seed, literal=stage.config.profile == "paper")
    return BaselineState(learner, env, env.finished)


def take_baseline(stage: Stage, state: BaselineState) -> Snapshot:
    """The training as it stands after an epoch; the replay is not copied."""
    env, learner = state.env, state.learner
    parts = {"learner": learner.arrays(), "world": env.world.state(), "env": {"lane_return": env.lane_return.copy()}}
    values = {
        "next_episode": env.world.next_episode,
        "action_generator": learner.action_generator.bit_generator.state,
    }
    return Snapshot(
        stage.index,
        common_values(stage, state.reported) | values,
        common_arrays(stage, state.reported) | joined(parts),
        learner.slots,
    )


def resume_baseline(stage: Stage, state: BaselineState, snapshot: Snapshot) -> None:
    """Put a fresh state where `take_baseline` took the snapshot.

    Raises:
        SnapshotError: it was taken of another training or by another version.
    """
    with_reason(stage, snapshot, lambda: _restore(stage, state, snapshot))


def _restore(stage: Stage, state: BaselineState, snapshot: Snapshot) -> None:
    env, values, arrays = state.env, snapshot.values, snapshot.arrays
    restore_common(stage, state.reported, snapshot)
    env.world.restore(below("world", arrays))
    env.world.next_episode = values["next_episode"]
    env.lane_return[:] = below("env", arrays)["lane_return"]
    state.learner.action_generator.bit_generator.state = values["action_generator"]
    # Last, for it puts back the generators from which everything before might have drawn.
    state.learner.restore(below("learner", arrays), snapshot.slots)


def run_epoch(stage: Stage, state: BaselineState) -> None:
    """Collect and learn for one epoch."""
    state.epoch += 1
    state.counts = EpochCounts()
    steps, updates = state.env_steps, state.learner.updates
    state.env_steps = state.learner.learn(stage.hyper.steps_per_epoch)
    state.counts.steps = state.env_steps - steps
    state.counts.updates = state.learner.updates - updates


def evaluate_epoch(stage: Stage, state: BaselineState, recorder: Recorder) -> Evaluation | None:
    """Evaluate every `evaluate_every` epochs and at the end, and keep the best policy."""
    if state.epoch % stage.hyper.evaluate_every and state.epoch != stage.hyper.epochs:
        return None
    return keep_best(stage, state, recorder)


def keep_best(stage: Stage, state: BaselineState, recorder: Recorder) -> Evaluation:
    """Evaluate the policy as it is now and hand it to the recorder if it is the best so far."""
    policy = current_policy(stage, state)
    evaluation = state.evaluation = examine(stage, state.reported, policy)
    if is_better(evaluation, state.best_evaluation):
        card = card_of(stage, state.reported, evaluation)
        policy.card = dataclasses.replace(card, activation=policy.activation, squash=policy.squash)
        state.best, state.best_evaluation = policy, evaluation
        recorder.policy(policy, policy.card)
        text = f"{stage.task.name}: {evaluation.success_rate:.1%} success in held-out evaluation"
        recorder.event("best", text, task=stage.task.name, epoch=state.epoch, success_rate=evaluation.success_rate)
    return evaluation


def current_policy(stage: Stage, state: BaselineState) -> NetworkPolicy:
    """The deterministic action of the learner as a policy of its own."""
    features, learner = stage.domain.features(stage.task.layout), state.learner
    return NetworkPolicy(
        policy_name(stage),
        features,
        learner.layers(),
        stage.domain.action_limit,
        activation=learner.activation,
        squash=learner.squash,
    )


def baseline_row(stage: Stage, state: BaselineState, evaluation: Evaluation | None) -> dict[str, Any]:
    """The metrics row of an epoch with the columns of `epoch_row`; what concerns a guide is None."""
    return {**epoch_row(stage, state.reported, evaluation), "transfer_share": None, "guide_share": None}
