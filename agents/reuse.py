"""Policy reuse: the guide collects part of the experience (§3.3.3)."""

from __future__ import annotations

import numpy as np

from agents.task import BoolArray, FloatArray


def composite_action(own: FloatArray, guide: FloatArray, allowed: BoolArray) -> FloatArray:
    """Composite policy μ_c: the guide where transfer is allowed, otherwise the policy in training.

    Eq. (17), §3.3.3. Actions `[B, 1]` [rad], transfer condition `[B]`.
    """
    return np.where(allowed[:, None], guide, own)


def behaviour_action(own: FloatArray, composite: FloatArray, reused: BoolArray) -> FloatArray:
    """Behaviour policy μ_b: μ_c for the lanes whose draw of ε fell on reuse, otherwise the policy in training.

    Eq. (18), §3.3.3. Actions `[B, 1]` [rad], draws `[B]` from `draw_reuse`.
    """
    return np.where(reused[:, None], composite, own)


def draw_reuse(
    reused: BoolArray,
    restarted: BoolArray,
    epsilon: float,
    segment_steps: int,
    generator: np.random.Generator,
) -> BoolArray:
    """Which lanes reuse the guide in this step `[L]`: with probability ε, Eq. (18).

    A draw holds for a segment of `segment_steps` steps on average; 1 draws at every step, as the paper does. Per
    step the guide corrects every error at once and the learner never meets the states its own policy leads to.

    Args:
        reused: the draws of the step before `[L]`.
        restarted: lanes whose episode starts with this step `[L]`; they always draw.
        epsilon: probability of reuse.
        segment_steps: mean length of a segment; each step ends one with probability 1 / `segment_steps`.
        generator: source of the draws.
    """
    ended = restarted | (generator.random(len(reused)) < 1.0 / segment_steps)
    return np.where(ended, generator.random(len(reused)) < epsilon, reused)
