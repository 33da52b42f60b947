"""Algorithm 4: one stage, line by line as far as it can be seen from outside."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from agents.collection import Collector
from agents.knowledge_transfer import knowledge_transfer, run_epoch, update_weights
from agents.training_state import start_stage
from tests.agents.point_robot import POINT_ROBOT
from tests.agents.recording import Recording
from tests.agents.stages import stage_for


def test_lines_1_and_2_start_with_full_weights_and_equal_targets() -> None:
    state = start_stage(stage_for())
    assert (state.alpha, state.epsilon, state.beta, state.replay.size) == (1.0, 0.8, 0.0, 0)
    learner = state.learner
    for online, target in zip(learner.critics.parameters(), learner.target_critics.parameters(), strict=True):
        assert torch.equal(online, target) and online is not target


@pytest.mark.parametrize(("variant", "alpha", "epsilon"), [("wo-pd", 0.0, 0.8), ("wo-pr", 1.0, 0.0), ("td3", 0, 0)])
def test_a_part_that_is_switched_off_starts_and_stays_at_zero(variant: str, alpha: float, epsilon: float) -> None:
    stage = stage_for(variant)
    state = start_stage(stage)
    assert (state.alpha, state.epsilon) == (alpha, epsilon)
    state.beta = 0.5
    update_weights(stage, state)
    assert (state.alpha == 0.0, state.epsilon == 0.0) == (alpha == 0.0, epsilon == 0.0)


def test_lines_4_to_9_store_what_happened() -> None:
    stage = stage_for()
    state = start_stage(stage)
    before = state.observation.copy()
    Collector(stage).step(state)
    features = POINT_ROBOT.features(stage.task.layout)
    batch = state.replay.batch(torch.arange(state.replay.size)[:, None], stage.hyper.gamma)
    np.testing.assert_array_equal(batch.features.numpy(), features.encode(before))
    # D compares the executed action, in action units, with the guide's: no obstacle is in sight at the start.
    executed = batch.action.numpy() * POINT_ROBOT.action_limit
    wanted = np.clip(before[:, [3]], -POINT_ROBOT.action_limit, POINT_ROBOT.action_limit)
    np.testing.assert_allclose(batch.imitation.numpy(), -np.abs(executed - wanted)[:, 0], atol=1e-6)
    assert batch.reward.tolist() == pytest.approx([-0.02] * 8)


def test_lines_11_to_22_make_exactly_the_configured_number_of_updates() -> None:
    stage = stage_for()
    state = start_stage(stage)
    run_epoch(stage, state, Collector(stage))
    # 25 steps of 8 lanes; updates start with the tenth, when 80 transitions are stored.
    assert state.env_steps == 200
    assert state.learner.updates == state.counts.updates == 16 * 3


def test_lines_23_to_25_move_both_weights_by_the_success_rate_within_the_clips() -> None:
    stage = stage_for()
    state = start_stage(stage)
    state.beta = 0.9
    update_weights(stage, state)
    assert (state.alpha, state.epsilon) == (0.75, pytest.approx(0.55))
    state.alpha, state.epsilon = 0.2, 0.1
    update_weights(stage, state)
    assert (state.alpha, state.epsilon) == (pytest.approx(0.1), pytest.approx(0.08))


def test_a_stage_reports_every_epoch_and_hands_over_its_best_policy() -> None:
    recording = Recording()
    policy = knowledge_transfer(stage_for(), recording)
    assert [row["epoch"] for row in recording.rows] == [1, 2]
    assert recording.kinds()[0] == "stage_started" and recording.kinds()[-1] == "stage_finished"
    last, card = recording.policies[-1]
    assert last is policy and card.final and card.missiles == (1,) and card.seed == 3
    # The card tells of fresh episodes: those that chose the policy would flatter it.
    assert card.evaluation is not None and card.evaluation["seed"] == stage_for().final_seed
    assert card.evaluation["episodes"] == stage_for().hyper.final_episodes


def test_episodes_that_train_that_choose_and_that_judge_are_never_the_same() -> None:
    stages = [dataclasses.replace(stage_for(), config=dataclasses.replace(stage_for().config, seed=s)) for s in (0, 99)]
    seeds = {seed for stage in stages for seed in (stage.seed, stage.held_out_seed, stage.final_seed)}
    assert len(seeds) == 6
    # Nor any that a person types.
    assert min(seeds) > 2**41


def test_the_same_seed_gives_the_same_policy_and_another_seed_another() -> None:
    def weights(seed: int) -> list[float]:
        stage = stage_for()
        stage = dataclasses.replace(stage, config=dataclasses.replace(stage.config, seed=seed))
        return np.concatenate([w.ravel() for w, _ in knowledge_transfer(stage, Recording()).layers]).tolist()

    assert weights(1) == weights(1) != weights(2)
