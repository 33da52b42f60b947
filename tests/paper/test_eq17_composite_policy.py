"""Eq. (17): the guide where transfer is allowed, the policy in training elsewhere."""

from __future__ import annotations

import numpy as np

from agents.reuse import composite_action


def test_hand_written() -> None:
    own, guide = np.array([[0.1], [0.2]]), np.array([[-0.1], [-0.2]])
    assert composite_action(own, guide, np.array([True, False])).tolist() == [[-0.1], [0.2]]
