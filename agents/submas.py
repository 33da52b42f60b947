"""SubMas-RL: Algorithm 5, the whole chain from the easiest task to the target, or one stage of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from agents.config import VARIANTS, ConfigError, Hyperparameters, TrainingConfig, numbers_of
from agents.curriculum import Curriculum, learn_with_curriculum
from agents.expert import NavigationExpert
from agents.features import subtask_number
from agents.knowledge_transfer import knowledge_transfer
from agents.numerics import prepare_torch
from agents.policy import Policy
from agents.recorder import Recorder
from agents.snapshot import Snapshot
from agents.stage import Stage
from agents.task import Domain, SubtaskTask

LearnStage = Callable[[int, Any, Any, Policy], Policy]
"""(stage number, task 𝒯_k, source task 𝒯_i, guide μ_i) -> trained policy μ_k."""


def submas(
    curriculum: Curriculum,
    expert: Policy,
    learn_stage: LearnStage,
    stopped: Callable[[], bool] = lambda: False,
    first: int = 0,
) -> Policy:
    """Train along the chain, each policy guiding the next: Algorithm 5, §3.4.

    Args:
        curriculum: the chain of tasks, made by Algorithm 3.
        expert: policy of the easiest task, μ_n; of the task before stage `first`, if that is not 0.
        learn_stage: Algorithm 4 for one pair of adjacent tasks.
        stopped: asked after every stage; True leaves the rest of the chain out.
        first: number of stages that are learned already.

    Returns:
        Policy of the target task, or of the last stage that was trained.
    """
    policy = expert
    for number, (i, k) in list(enumerate(reversed(curriculum.edges)))[first:]:
        policy = learn_stage(number, curriculum.tasks[k], curriculum.tasks[i], policy)
        if stopped():
            break
    return policy


def train(
    config: TrainingConfig,
    recorder: Recorder,
    guide: Policy,
    *,
    domain: Domain | None = None,
    hyperparameters: Hyperparameters | None = None,
    snapshot: Snapshot | None = None,
) -> Policy:
    """Run one training: the curriculum (Algorithm 5), a single stage (Algorithm 4), or SAC or PPO from scratch (§4.3).

    Args:
        config: what to train.
        recorder: told about every epoch, event and policy; may ask to stop.
        guide: policy that guides the stage, or the first stage of a curriculum.
        domain: where tasks come from; the paper's domain by default.
        hyperparameters: numbers to use instead of those of the configured profile.
        snapshot: where to go on, of an interrupted training with this configuration; it brings its own numbers.

    Raises:
        ConfigError: the task has no missile, so there is nothing to learn.
        SnapshotError: the snapshot is not one of such a training.
    """
    domain = domain or _evasion()
    target = domain.target(config.scenario, config.missiles).mask(numbers_of("mask", config.mask))
    subtasks = domain.subtasks(target)
    if not subtasks:
        raise ConfigError(f"missiles is {config.missiles}; the expert solves a task without any, train 1 or more")
    stages = len(subtasks) if config.curriculum else 1
    hyper, first = hyperparameters or config.hyperparameters, 0
    if snapshot is None:
        recorder.event("numerics", f"matrix products: {prepare_torch()}")
    else:
        prepare_torch(route=snapshot.route)
        hyper, first, guide = snapshot.hyperparameters, snapshot.checked_stage(stages), snapshot.guide(guide, domain)

    def learn_stage(number: int, task: Any, source: Any, stage_guide: Policy) -> Policy:
        stage = Stage(
            task=task,
            source=source,
            guide=stage_guide,
            domain=domain,
            hyper=hyper,
            variant=VARIANTS[config.variant],
            config=config,
            index=number,
            count=stages,
        )
        resumed = snapshot if number == first else None
        if stage.variant.from_library:
            from agents.baselines import learn_baseline  # who trains SubMas-RL need not wait for the library

            return learn_baseline(stage, recorder, resumed)
        return knowledge_transfer(stage, recorder, resumed)

    if not config.curriculum:
        return learn_stage(0, target, source_of(target, subtasks, guide), guide)

    def learn(chain: Curriculum) -> Policy:
        return submas(chain, guide, learn_stage, recorder.should_stop, first)

    return learn_with_curriculum(target, config.ordered_subtasks, learn)


def source_of(task: SubtaskTask, subtasks: Sequence[int], guide: Policy) -> Any:
    """The task whose subtasks a guide knows: it decides where the transfer mask lets the guide help.

    A network knows the subtasks it was trained with, the navigation expert none. Any other rule is taken for a
    policy of the next easier task.
    """
    if isinstance(guide, NavigationExpert):
        return task.mask(subtasks)
    if guide.layout is None:
        return task.mask(subtasks[-1:])
    known = {subtask_number(name) for name in guide.layout.names}
    return task.mask([subtask for subtask in subtasks if subtask not in known])


def _evasion() -> Domain:
    from agents.evasion import EVASION

    return EVASION
