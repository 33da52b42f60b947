"""Knowledge transfer based on TD3: Algorithm 4, one stage of the curriculum."""

from __future__ import annotations

import dataclasses

from agents.card import card_of
from agents.collection import Collector
from agents.evaluation import Evaluation
from agents.metrics import epoch_row
from agents.policy import NetworkPolicy
from agents.promotion import current_policy, examine, is_better, judge, promotion_reason
from agents.recorder import Recorder
from agents.resume import resume_stage, take_snapshot
from agents.snapshot import Snapshot
from agents.stage import Stage
from agents.training_state import EpochCounts, TrainingState, start_stage
from agents.weights import next_alpha, next_epsilon


def knowledge_transfer(stage: Stage, recorder: Recorder, snapshot: Snapshot | None = None) -> NetworkPolicy:
    """Train a policy for the stage's task with the help of its guide; the best one by held-out evaluation.

    Algorithm 4, §3.4. The stage ends when it is passed, after its last epoch, or when the recorder says so. With a
    `snapshot` of this stage it goes on from there, bit for bit as if it had never been interrupted.
    """
    state = resume_stage(stage, snapshot) if snapshot else start_stage(stage)
    collector = Collector(stage)
    if not snapshot:
        how = f"guided by {stage.guide.name}" if stage.variant.guided else "learned from scratch"
        recorder.event("stage_started", f"{stage.task.name} {how}", task=stage.task.name)
    # A snapshot is taken before it is asked whether the stage is over.
    reason = end_reason(stage, state, recorder) if snapshot else ""
    while not reason:
        run_epoch(stage, state, collector)
        evaluation = evaluate_epoch(stage, state, recorder)
        # The row shows the weights the epoch was run with; Algorithm 4 moves them at its end.
        recorder.epoch(epoch_row(stage, state, evaluation))
        update_weights(stage, state)
        recorder.checkpoint(lambda: take_snapshot(stage, state))
        reason = end_reason(stage, state, recorder)
    return finish_stage(stage, state, recorder, reason)


def run_epoch(stage: Stage, state: TrainingState, collector: Collector) -> None:
    """Alternate one step of all lanes and a fixed number of gradient steps (Algorithm 4, lines 4-22)."""
    state.epoch += 1
    state.counts = EpochCounts()
    while state.counts.steps < stage.hyper.steps_per_epoch:
        collector.step(state)
        if state.replay.size >= max(stage.hyper.update_after, 1):
            run_updates(stage, state)


def run_updates(stage: Stage, state: TrainingState) -> None:
    """The gradient steps that follow one step of all lanes (Algorithm 4, lines 11-22)."""
    hyper = stage.hyper
    generator = state.learner.generator
    count, steps = hyper.updates_per_lane_step, hyper.return_steps
    for batch in state.replay.minibatches(count, hyper.batch_size, steps, hyper.gamma, generator):
        state.learner.update(batch, state.alpha)
    state.counts.updates += hyper.updates_per_lane_step


def evaluate_epoch(stage: Stage, state: TrainingState, recorder: Recorder) -> Evaluation | None:
    """Evaluate every `evaluate_every` epochs and at the end, keep the best policy, and count β (line 23)."""
    hyper = stage.hyper
    evaluation = None
    if state.epoch % hyper.evaluate_every == 0 or state.epoch == hyper.epochs:
        policy = current_policy(stage, state)
        evaluation = state.evaluation = examine(stage, state, policy)
        if is_better(evaluation, state.best_evaluation):
            keep_best(stage, state, recorder, policy, evaluation)
    if hyper.beta_source == "training" and state.finished:
        state.beta = sum(episode.success for episode in state.finished) / len(state.finished)
    elif hyper.beta_source == "evaluation" and evaluation is not None:
        state.beta = evaluation.success_rate
    return evaluation


def keep_best(
    stage: Stage, state: TrainingState, recorder: Recorder, policy: NetworkPolicy, evaluation: Evaluation
) -> None:
    """Remember the policy as the stage's best and hand it to the recorder."""
    policy.card = card_of(stage, state, evaluation)
    state.best, state.best_evaluation = policy, evaluation
    recorder.policy(policy, policy.card)
    text = f"{stage.task.name}: {evaluation.success_rate:.1%} success in held-out evaluation"
    recorder.event("best", text, task=stage.task.name, epoch=state.epoch, success_rate=evaluation.success_rate)


def update_weights(stage: Stage, state: TrainingState) -> None:
    """Move α and ε after an epoch (Algorithm 4, lines 24-25); a part that is switched off stays at 0."""
    hyper, variant = stage.hyper, stage.variant
    moment = (state.epoch, hyper.epochs)
    if variant.distillation:
        state.alpha = next_alpha(state.alpha, state.beta, hyper.alpha_clip, variant.alpha, *moment)
    if variant.reuse:
        state.epsilon = next_epsilon(
            state.epsilon, state.beta, hyper.epsilon_start, hyper.epsilon_clip, variant.epsilon, *moment
        )


def end_reason(stage: Stage, state: TrainingState, recorder: Recorder) -> str:
    """Why the stage ends after this epoch, as an event's text; empty while it goes on."""
    promoted = promotion_reason(state, stage.hyper)
    if promoted:
        recorder.event("promoted", f"{stage.task.name}: {promoted}", task=stage.task.name, epoch=state.epoch)
        return promoted
    if recorder.should_stop():
        recorder.event("stopped", f"{stage.task.name}: asked to stop", task=stage.task.name, epoch=state.epoch)
        return "asked to stop"
    return f"all {stage.hyper.epochs} epochs done" if state.epoch >= stage.hyper.epochs else ""


def finish_stage(stage: Stage, state: TrainingState, recorder: Recorder, reason: str) -> NetworkPolicy:
    """Hand over the stage's best policy for good, with the figures of episodes that had no part in choosing it."""
    policy = state.best or current_policy(stage, state)
    card = policy.card or card_of(stage, state, state.best_evaluation)
    final = judge(stage, policy)
    policy.card = dataclasses.replace(card, final=True, evaluation=final.to_json())
    recorder.policy(policy, policy.card)
    text = f"{stage.task.name}: {reason}; {final.success_rate:.1%} of {final.episodes} fresh episodes"
    fields = {"task": stage.task.name, "epoch": state.epoch, "reason": reason, "success_rate": final.success_rate}
    recorder.event("stage_finished", text, **fields)
    return policy
