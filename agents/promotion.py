"""Held-out evaluation during training: which policy is kept, and when a stage is passed."""

from __future__ import annotations

from agents.evaluation import Evaluation, evaluate, pooled
from agents.hyperparameters import Hyperparameters
from agents.policy import NetworkPolicy
from agents.stage import Stage
from agents.training_state import TrainingState


def current_policy(stage: Stage, state: TrainingState) -> NetworkPolicy:
    """The averaged actor (or the actor itself, without averaging) as a policy of its own."""
    learner = state.learner
    actor = learner.average_actor if stage.hyper.actor_average > 0.0 else learner.actor
    features = stage.domain.features(stage.task.layout)
    return NetworkPolicy(policy_name(stage), features, actor.arrays(), stage.domain.action_limit)


def policy_name(stage: Stage) -> str:
    """Name of what this stage makes: `submas-source-3`, `dec-pd-target`."""
    return f"{stage.config.variant}-{stage.task.name}"


def evaluate_held_out(stage: Stage, state: TrainingState, policy: NetworkPolicy) -> Evaluation:
    """Fly the policy, without noise or guide, on initial states that nothing was trained or chosen on before."""
    evaluation = evaluate(
        policy,
        stage.task,
        stage.hyper.evaluation_episodes,
        stage.held_out_seed,
        domain=stage.domain,
        first_episode=state.evaluated_episodes,
    )
    state.evaluated_episodes += evaluation.episodes
    return evaluation


def examine(stage: Stage, state: TrainingState, policy: NetworkPolicy) -> Evaluation:
    """Evaluate a policy; while it is good enough for promotion, again on fresh episodes, up to the configured times.

    The policy itself is confirmed, not its successor: an actor that still learns swings from one epoch to the next.

    Returns:
        All episodes flown, pooled.
    """
    hyper = stage.hyper
    flown = [evaluate_held_out(stage, state, policy)]
    while flown[-1].success_rate >= hyper.promotion_success and len(flown) < hyper.promotion_evaluations:
        flown.append(evaluate_held_out(stage, state, policy))
    rates = tuple(evaluation.success_rate for evaluation in flown)
    state.passes = tuple(rate for rate in rates if rate >= hyper.promotion_success)
    return pooled(flown)


def judge(stage: Stage, policy: NetworkPolicy) -> Evaluation:
    """Evaluate the stage's policy on initial states that were used neither to train nor to choose it."""
    return evaluate(policy, stage.task, stage.hyper.final_episodes, stage.final_seed, domain=stage.domain)


def is_better(new: Evaluation, best: Evaluation | None) -> bool:
    """More successes, or as many with a higher return."""
    if best is None:
        return True
    return (new.success_rate, new.mean_return) > (best.success_rate, best.mean_return)


def promotion_reason(state: TrainingState, hyper: Hyperparameters) -> str:
    """Why the stage is passed, as a sentence; empty while it is not.

    A stage is passed when `promotion_evaluations` held-out evaluations of one policy, each on fresh episodes, all
    show success at or above `promotion_success`. One alone would do by luck once in a while.
    """
    if len(state.passes) < hyper.promotion_evaluations:
        return ""
    return (
        f"{len(state.passes)} held-out evaluations of {hyper.evaluation_episodes} episodes with success of at least "
        f"{hyper.promotion_success:.1%}: {', '.join(f'{rate:.1%}' for rate in state.passes)}"
    )
