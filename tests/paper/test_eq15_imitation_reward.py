"""Eq. (15): D(s, a) = -‖a - μ_i(Ξ(s))‖ where transfer is allowed, 0 elsewhere."""

from __future__ import annotations

import numpy as np

from agents.distillation import imitation_reward


def test_hand_computed() -> None:
    action, guide = np.array([[0.3], [0.3], [-1.0]]), np.array([[0.5], [0.5], [1.0]])
    reward = imitation_reward(action, guide, np.array([True, False, True]))
    np.testing.assert_allclose(reward, [-0.2, 0.0, -2.0], rtol=1e-6)


def test_it_is_the_euclidean_distance_in_several_dimensions() -> None:
    reward = imitation_reward(np.array([[3.0, 0.0]]), np.array([[0.0, 4.0]]), np.array([True]))
    np.testing.assert_allclose(reward, [-5.0])


def test_acting_like_the_guide_costs_nothing() -> None:
    action = np.array([[0.4]], np.float32)
    assert imitation_reward(action, action, np.array([True])).item() == 0.0
