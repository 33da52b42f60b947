"""One agent of a stack: its chain of stages, and what Algorithms 4 and 5 decide on the host at the end of an epoch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from agents.config import VARIANTS, ConfigError, TrainingConfig, numbers_of
from agents.curriculum import build_curriculum
from agents.hyperparameters import Hyperparameters
from agents.knowledge_transfer import end_reason, evaluate_epoch, finish_stage, update_weights
from agents.metrics import epoch_row
from agents.policy import Policy
from agents.recorder import Recorder
from agents.snapshot import Snapshot
from agents.stacked.residence import Weights
from agents.stage import Stage
from agents.submas import source_of
from agents.task import Domain
from agents.td3 import LearnerStatistics
from agents.training_state import EpochCounts, TrainingState

Ended = Callable[[Exception | None], None]
"""Told once, when an agent's training is over: None when it came to its end, else what ended it."""


@dataclass(frozen=True)
class Member:
    """One training that is to be part of a stack."""

    config: TrainingConfig
    recorder: Recorder
    guide: Policy
    """Guides the (first) stage."""
    ended: Ended = lambda _error: None
    abandoned: Callable[[], bool] = lambda: False
    """Asked at every step; True ends the training where it stands, without a last evaluation."""


class Abandoned(Exception):
    """A training was to end at once."""


@dataclass(frozen=True)
class HostActor:
    """Weights of an actor at the end of an epoch, fetched from the device."""

    weights: Weights

    def arrays(self) -> Weights:
        """Weights `[out, in]` and biases `[out]`, first layer to last."""
        return self.weights


@dataclass(frozen=True)
class HostLearner:
    """What the end of an epoch asks of a learner, as `agents.td3.Td3` tells it."""

    actor: HostActor
    average_actor: HostActor
    updates: int
    statistics: LearnerStatistics

    def take_statistics(self) -> LearnerStatistics:
        """Mean losses of the epoch."""
        return self.statistics


class Agent:
    """One training within a stack. What it does at the end of an epoch is the code of a training by itself."""

    def __init__(self, member: Member, domain: Domain, hyper: Hyperparameters) -> None:
        """Work out the chain of stages.

        Raises:
            ConfigError: there is nothing to learn, or SAC or PPO is to learn it.
        """
        self.member, self.domain, self.hyper = member, domain, hyper
        if VARIANTS[member.config.variant].from_library:
            raise ConfigError(f"variant '{member.config.variant}' cannot be stacked; leave --stacked and --device out")
        self.legs = legs(member.config, domain, member.guide)
        self.number = 0
        self.stage = self._stage(member.guide)
        self.state = fresh_state(self.stage)
        self.over = False
        self.failure: Exception | None = None

    def begin(self, numerics: str) -> None:
        """Say that the stage begins, and with the first one how this training computes."""
        task, guide = self.stage.task, self.stage.guide
        if self.number == 0:
            self.member.recorder.event("numerics", numerics)
        how = f"guided by {guide.name}" if self.stage.variant.guided else "learned from scratch"
        self.member.recorder.event("stage_started", f"{task.name} {how}", task=task.name)

    def close_epoch(self, take: Callable[[], Snapshot]) -> Policy | None:
        """Evaluate, report, move α and ε (Algorithm 4, lines 23-25); the stage's policy where the stage is over.

        Whatever goes wrong ends this agent and no other. `take` takes the snapshot that is offered to the recorder.
        """
        try:
            return self._close_epoch(take)
        except Exception as error:  # its reason is handed to the run it belongs to
            self.over, self.failure = True, error
            return None

    def _close_epoch(self, take: Callable[[], Snapshot]) -> Policy | None:
        stage, state, recorder = self.stage, self.state, self.member.recorder
        evaluation = evaluate_epoch(stage, state, recorder)
        recorder.epoch(epoch_row(stage, state, evaluation))
        update_weights(stage, state)
        recorder.checkpoint(take)
        reason = end_reason(stage, state, recorder)
        if not reason:
            return None
        policy = finish_stage(stage, state, recorder, reason)
        self.over = self.number + 1 == len(self.legs) or recorder.should_stop()
        return policy

    def advance(self, policy: Policy) -> None:
        """Go on to the next stage, guided by the policy of this one (Algorithm 5)."""
        self.number += 1
        self.stage = self._stage(policy)
        self.state = fresh_state(self.stage)

    def _stage(self, guide: Policy) -> Stage:
        task, source = self.legs[self.number]
        config = self.member.config
        return Stage(
            task=task,
            source=source,
            guide=guide,
            domain=self.domain,
            hyper=self.hyper,
            variant=VARIANTS[config.variant],
            config=config,
            index=self.number,
            count=len(self.legs),
        )


def legs(config: TrainingConfig, domain: Domain, guide: Policy) -> list[tuple[Any, Any]]:
    """(task, the task its guide knows) of every stage, in the order of Algorithm 5.

    Raises:
        ConfigError: the task has no subtask.
    """
    target = domain.target(config.scenario, config.missiles).mask(numbers_of("mask", config.mask))
    subtasks = domain.subtasks(target)
    if not subtasks:
        raise ConfigError(f"missiles is {config.missiles}; the expert solves a task without any, train 1 or more")
    if not config.curriculum:
        return [(target, source_of(target, subtasks, guide))]
    chain = build_curriculum(target, config.ordered_subtasks)
    return [(chain.tasks[k], chain.tasks[i]) for i, k in reversed(chain.edges)]


def fresh_state(stage: Stage) -> TrainingState:
    """β = 0, α = 1, ε = ε₀ (Algorithm 4, line 2), as `start_stage`; what is stacked lives elsewhere."""
    stacked: Any = None
    return TrainingState(
        learner=stacked,
        replay=stacked,
        world=stacked,
        observation=stacked,
        features=stacked,
        reused=stacked,
        noise=stacked,
        restarted=stacked,
        lane_return=stacked,
        generator=stacked,
        alpha=1.0 if stage.variant.distillation else 0.0,
        epsilon=stage.hyper.epsilon_start if stage.variant.reuse else 0.0,
        counts=EpochCounts(),
    )
