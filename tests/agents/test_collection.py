"""What is stored while collecting: ends of episodes, true next observations, and who acted."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import torch

from agents.collection import Collector
from agents.config import PROFILES, VARIANTS, TrainingConfig
from agents.expert import RandomPolicy
from agents.replay import Batch
from agents.stage import Stage
from agents.training_state import TrainingState, start_stage
from tests.agents.clock import Clock, ClockTask

HYPER = dataclasses.replace(PROFILES["smoke"], hidden=(16,), lanes=16, reward_scale=1.0, segment_steps=1)


class Still(RandomPolicy):
    """A guide that never turns."""

    def act(self, observation: np.ndarray, layout: object) -> np.ndarray:
        return np.zeros((len(observation), 1), np.float32)


def _collect(clock: Clock, steps: int, **changes: object) -> tuple[Stage, TrainingState, Batch]:
    stage = Stage(
        task=ClockTask(),
        source=ClockTask(),
        guide=Still(),
        domain=clock,
        hyper=dataclasses.replace(HYPER, **changes),
        variant=VARIANTS["submas"],
        config=TrainingConfig(missiles=1),
    )
    state = start_stage(stage)
    collector = Collector(stage)
    for _ in range(steps):
        collector.step(state)
    return stage, state, state.replay.batch(torch.arange(state.replay.size)[:, None], stage.hyper.gamma)


@pytest.mark.parametrize("terminates", [False, True])
def test_no_transition_mixes_two_episodes_and_ends_are_stored_as_what_they_are(terminates: bool) -> None:
    _, _, batch = _collect(Clock(limit=8, terminates=terminates), 40)
    episode, step = batch.features.T
    next_episode, next_step = batch.next_features.T
    assert torch.equal(episode, next_episode)
    assert torch.equal(step + 1, next_step)
    last = next_step == 8
    assert last.sum() == 16 * 5  # every lane ends once in eight steps, and nothing is lost
    assert torch.equal(batch.discount == 0.0, last & terminates)


def test_every_lane_gets_noise_of_its_own() -> None:
    _, _, batch = _collect(Clock(), 30, action_noise=0.05, epsilon_start=1.0)
    # The guide never turns and always acts, so the action is the noise: 0.05 of a limit of 0.6.
    noise = batch.action.reshape(30, 16) * 0.6
    assert len(noise.unique()) == 30 * 16
    assert noise.std().item() == pytest.approx(0.05, rel=0.15)
    correlation = np.corrcoef(noise.numpy().T)
    assert np.abs(correlation[~np.eye(16, dtype=bool)]).max() < 0.7


def test_epsilon_zero_collects_with_the_policy_in_training_alone() -> None:
    _, state, batch = _collect(Clock(), 10, action_noise=0.0, epsilon_start=0.0)
    with torch.no_grad():
        torch.testing.assert_close(batch.action, state.learner.actor(batch.features))


def test_the_steps_that_the_guide_flew_are_counted() -> None:
    _, state, batch = _collect(Clock(), 40, action_noise=0.0, epsilon_start=0.3)
    # The guide never turns, and the policy in training, which nothing has moved yet, always does a little.
    assert state.counts.guided == int((batch.action == 0.0).sum())
    assert state.counts.guided / state.counts.steps == pytest.approx(0.3, abs=0.06)
    assert state.counts.transfer_allowed == state.counts.steps


def test_actions_stay_within_the_limit() -> None:
    _, _, batch = _collect(Clock(), 20, action_noise=2.0)
    assert batch.action.abs().max() <= 1.0


def test_finished_episodes_are_counted_with_their_whole_return() -> None:
    _, state, _ = _collect(Clock(limit=8, terminates=True), 24)
    whole = [episode for episode in state.finished if episode.steps == 8]
    assert len(state.finished) == 16 * 3
    assert all(episode.success for episode in state.finished)
    # Lanes were started at different steps, so the first episode of a lane may be shorter than its steps say.
    assert sorted({episode.episode_return for episode in whole})[-1] == 8.0


@pytest.mark.parametrize(("terminates", "low", "high"), [(False, 9.0, 10.5), (True, 3.5, 5.5)])
def test_values_pass_through_truncation_and_stop_at_termination(terminates: bool, low: float, high: float) -> None:
    """A reward of 1 for ever at γ = 0.9 is worth 10; if every eighth step ends it for good, 4.7."""
    _, state, _ = _collect(
        Clock(limit=8, terminates=terminates, scale=1e9),
        40,
        gamma=0.9,
        learning_rate=3e-3,
        polyak=0.05,
        two_returns=False,
        layer_norm=False,
    )
    for batch in state.replay.minibatches(1200, 64, 1, 0.9, torch.Generator().manual_seed(0)):
        state.learner.update(batch, alpha=0.0)
    value = state.learner.critics.first(torch.zeros((1, 2)), torch.zeros((1, 1))).item()
    assert low < value < high
