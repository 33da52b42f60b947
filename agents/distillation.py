"""Policy distillation: an auxiliary reward for acting like the guide where its knowledge holds (§3.3.2)."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from agents.task import BoolArray, FloatArray

Rewards = TypeVar("Rewards", bound=Any)


def imitation_reward(action: FloatArray, guide_action: FloatArray, allowed: BoolArray) -> FloatArray:
    """Auxiliary reward D(s, a) `[B]`: minus the distance to the guide's action, 0 where transfer is masked.

    Eq. (15), §3.3.2. It is computed with the executed action, exploration noise included.

    Args:
        action: executed actions `[B, n]` [rad].
        guide_action: actions of the guide for the same states `[B, n]` [rad].
        allowed: the transfer condition, Eq. (13), `[B]`.
    """
    distance = np.linalg.norm(action - guide_action, axis=1)
    return np.where(allowed, -distance, 0.0).astype(np.float32)


def distilled_reward(reward: Rewards, imitation: Rewards, alpha: float) -> Rewards:
    """Reward that the learner maximises, R + α D: Eq. (14), §3.3.2; all `[B]`, arrays or tensors alike."""
    return reward + alpha * imitation
