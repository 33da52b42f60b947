"""All that changes while a stage is trained, in one record."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from agents.evaluation import Evaluation
from agents.policy import NetworkPolicy
from agents.replay import Replay
from agents.stage import Stage
from agents.task import BoolArray, FloatArray
from agents.td3 import Td3
from agents.td3_fast import FastTd3

TRAINING_WINDOW = 100
"""Training episodes that the training success rate looks back on."""


@dataclass(frozen=True)
class FinishedEpisode:
    """Outcome of one training episode, flown by the behaviour policy."""

    success: bool
    episode_return: float
    steps: int


@dataclass
class EpochCounts:
    """What happened since the epoch began."""

    steps: int = 0
    updates: int = 0
    transfer_allowed: int = 0
    """Lane-steps in which the transfer mask allowed transfer."""
    guided: int = 0
    """Lane-steps that the guide flew: reuse was drawn, and transfer allowed."""
    started: float = field(default_factory=time.perf_counter)


@dataclass
class TrainingState:
    """Mutable state of Algorithm 4. Nothing else in `agents` remembers anything between two steps."""

    learner: Td3
    replay: Replay
    world: Any
    """The `TaskWorld` that is explored."""
    observation: FloatArray
    """Current observations `[L, d]`, physical units."""
    features: FloatArray
    """The same, encoded `[L, f]`."""
    reused: BoolArray
    """Lanes whose last draw of ε fell on reuse `[L]`."""
    noise: FloatArray
    """Exploration noise of the step before `[L, 1]` [action units]."""
    restarted: BoolArray
    """Lanes whose episode has just begun `[L]`."""
    lane_return: FloatArray
    """Return of the running episodes `[L]`."""
    generator: np.random.Generator
    """Exploration noise and draws of ε."""
    alpha: float
    """Weight of policy distillation."""
    epsilon: float
    """Probability of policy reuse."""
    beta: float = 0.0
    """Success rate that drives both."""
    epoch: int = 0
    env_steps: int = 0
    counts: EpochCounts = field(default_factory=EpochCounts)
    finished: deque[FinishedEpisode] = field(default_factory=lambda: deque(maxlen=TRAINING_WINDOW))
    evaluation: Evaluation | None = None
    """Latest held-out evaluation."""
    evaluated_episodes: int = 0
    """Held-out episodes used so far; every evaluation takes fresh ones."""
    passes: tuple[float, ...] = ()
    """Success rates of the latest policy's held-out evaluations, as far as each was good enough for promotion."""
    best: NetworkPolicy | None = None
    best_evaluation: Evaluation | None = None
    started: float = field(default_factory=time.perf_counter)
    cpu_started: float = field(default_factory=time.process_time)


def start_stage(stage: Stage) -> TrainingState:
    """Fresh networks, an empty replay, β = 0, α = 1 and ε = ε₀ (Algorithm 4, lines 1-2)."""
    hyper, domain, variant = stage.hyper, stage.domain, stage.variant
    features = domain.features(stage.task.layout)
    world = domain.world(stage.task, hyper.lanes, stage.seed)
    observation = world.reset()
    return TrainingState(
        learner=FastTd3(features.size, hyper, domain.action_limit, stage.seed),
        replay=Replay(hyper.replay_size, hyper.lanes, features.size),
        world=world,
        observation=observation,
        features=features.encode(observation),
        reused=np.zeros(hyper.lanes, bool),
        noise=np.zeros((hyper.lanes, 1), np.float32),
        restarted=np.ones(hyper.lanes, bool),
        lane_return=np.zeros(hyper.lanes, np.float32),
        generator=np.random.default_rng(stage.seed),
        alpha=1.0 if variant.distillation else 0.0,
        epsilon=hyper.epsilon_start if variant.reuse else 0.0,
    )
