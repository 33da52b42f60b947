"""Makes the card of a policy that a stage has trained."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

from agents.checkpoint import PolicyCard
from agents.config import TrainingConfig
from agents.evaluation import Evaluation
from agents.promotion import policy_name
from agents.stage import Stage
from agents.training_state import TrainingState


def card_of(stage: Stage, state: TrainingState, evaluation: Evaluation | None) -> PolicyCard:
    """Card of the stage's policy as it is now."""
    domain, config = stage.domain, stage.config
    layout = stage.task.layout
    scenario, scenario_digest = domain.scenario(stage.task)
    return PolicyCard(
        name=policy_name(stage),
        task=stage.task.name,
        missiles=domain.subtasks(stage.task),
        hidden=stage.hyper.hidden,
        layout_digest=layout.digest,
        features_digest=domain.features(layout).digest,
        scenario=scenario,
        scenario_digest=scenario_digest,
        variant=config.variant,
        profile=config.profile,
        seed=config.seed,
        command=command_of(config),
        code_version=code_version(),
        epoch=state.epoch,
        env_steps=state.env_steps,
        updates=state.learner.updates,
        final=False,
        evaluation=evaluation.to_json() if evaluation else None,
    )


def command_of(config: TrainingConfig) -> str:
    """Command line that repeats this training; a curriculum always learns all missiles of its scenario."""
    words = ["workbench train", "--curriculum" if config.curriculum else f"--missiles {config.missiles}"]
    if config.mask:
        words.append(f"--mask {config.mask}")
    if config.order:
        words.append(f"--order {config.order}")
    if config.guide:
        words.append(f"--guide {config.guide}")
    if config.scenario != "default":
        words.append(f"--scenario {config.scenario}")
    words += [f"--variant {config.variant}", f"--profile {config.profile}", f"--seeds {config.seed}"]
    return " ".join(words)


def code_version() -> str:
    """Version of this package; `0` when it runs without being installed."""
    try:
        return version("submas-workbench")
    except PackageNotFoundError:
        return "0"
