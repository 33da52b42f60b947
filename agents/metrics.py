"""The metrics row of an epoch: every figure a page shows about learning."""

from __future__ import annotations

import time
from typing import Any

from agents.evaluation import Evaluation
from agents.stage import Stage
from agents.training_state import FinishedEpisode, TrainingState


def epoch_row(stage: Stage, state: TrainingState, evaluation: Evaluation | None) -> dict[str, Any]:
    """One row as plain JSON values; figures that were not measured in this epoch are None.

    `evaluation` is the held-out evaluation of this epoch. The epoch's counters are read and its losses taken.
    """
    return {
        **_place(stage, state),
        **_weights(state),
        "return_mean": evaluation.mean_return if evaluation else None,
        "success_rate": evaluation.success_rate if evaluation else None,
        "length_mean_s": evaluation.mean_length_s if evaluation else None,
        **_training_episodes(state),
        "transfer_share": state.counts.transfer_allowed / max(state.counts.steps, 1),
        "guide_share": state.counts.guided / max(state.counts.steps, 1),
        **_losses(state),
        **_speed(stage, state),
    }


def _place(stage: Stage, state: TrainingState) -> dict[str, Any]:
    return {
        "stage": stage.index,
        "stages": stage.count,
        "task": stage.task.name,
        "missiles": list(stage.domain.subtasks(stage.task)),
        "epoch": state.epoch,
        "epochs": stage.hyper.epochs,
        "env_steps": state.env_steps,
        "updates": state.learner.updates,
    }


def _weights(state: TrainingState) -> dict[str, Any]:
    return {"alpha": state.alpha, "epsilon": state.epsilon, "beta": state.beta}


def _training_episodes(state: TrainingState) -> dict[str, Any]:
    finished: list[FinishedEpisode] = list(state.finished)
    if not finished:
        return {"train_success_rate": None, "train_return_mean": None}
    return {
        "train_success_rate": sum(episode.success for episode in finished) / len(finished),
        "train_return_mean": sum(episode.episode_return for episode in finished) / len(finished),
    }


def _losses(state: TrainingState) -> dict[str, Any]:
    if state.counts.updates == 0:
        return {"critic_loss": None, "actor_loss": None, "q_mean": None}
    statistics = state.learner.take_statistics()
    return {
        "critic_loss": statistics.critic_loss,
        "actor_loss": statistics.actor_loss,
        "q_mean": statistics.q_mean,
    }


def _speed(stage: Stage, state: TrainingState) -> dict[str, Any]:
    now = time.perf_counter()
    epoch_s, stage_s = max(now - state.counts.started, 1e-9), now - state.started
    left = (stage.count - stage.index) * stage.hyper.epochs - state.epoch
    return {
        "updates_per_s": state.counts.updates / epoch_s,
        "env_steps_per_s": state.counts.steps / epoch_s,
        "wall_s": stage_s,
        "cpu_s": time.process_time() - state.cpu_started,
        "eta_s": stage_s / max(state.epoch, 1) * left,
    }
