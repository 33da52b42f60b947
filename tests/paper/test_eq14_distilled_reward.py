"""Eq. (14): the learner maximises R + α D, and α is applied when a transition is used, not when it is stored."""

from __future__ import annotations

import dataclasses

import numpy as np
import torch

from agents.config import PROFILES
from agents.distillation import distilled_reward
from agents.replay import Batch
from agents.td3 import Td3


def test_hand_computed() -> None:
    reward, imitation = np.array([50.0, -0.1]), np.array([-1.5, 0.0])
    np.testing.assert_allclose(distilled_reward(reward, imitation, 0.5), [49.25, -0.1])


def test_a_change_of_alpha_changes_the_target_of_the_same_batch() -> None:
    hyper = dataclasses.replace(PROFILES["smoke"], hidden=(4,), two_returns=False, reward_scale=1.0, gamma=0.9)
    learner = Td3(2, hyper, 1.0, seed=0)
    ones, features = torch.ones(3), torch.zeros((3, 2))
    batch = Batch(features, torch.zeros((3, 1)), 50.0 * ones, -2.0 * ones, 0.0 * ones, features)
    for alpha, expected in ((1.0, 48.0), (0.5, 49.0), (0.0, 50.0)):
        assert learner.targets(batch, alpha, learner.weights(alpha)).flatten().tolist() == [expected] * 3


def test_two_returns_keep_both_rewards_apart_whatever_alpha_is() -> None:
    learner = Td3(2, dataclasses.replace(PROFILES["smoke"], hidden=(4,), reward_scale=0.5), 1.0, seed=0)
    ones, features = torch.ones(2), torch.zeros((2, 2))
    batch = Batch(features, torch.zeros((2, 1)), 50.0 * ones, -2.0 * ones, 0.0 * ones, features)
    for alpha in (0.0, 0.7):
        assert learner.targets(batch, alpha, learner.weights(alpha)).tolist() == [[25.0, -1.0]] * 2
