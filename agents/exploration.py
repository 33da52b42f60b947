"""Exploration noise δ of Algorithm 4, line 5: drawn at every step, or held for a while."""

from __future__ import annotations

import numpy as np

from agents.task import BoolArray, FloatArray


def held_noise(
    noise: FloatArray, restarted: BoolArray, deviation: float, steps: int, generator: np.random.Generator
) -> FloatArray:
    """Noise of all lanes in this step `[L, 1]` [action units], δ ~ 𝒩(0, σ).

    With `steps` 1 every step has a draw of its own, as in the paper. A turn of a few degrees for one second changes
    next to nothing of what happens minutes later, so a critic learns from it what its own errors say; held for a
    while, the same turn leads somewhere, and the rewards of the following steps tell whether that was good.

    Args:
        noise: the noise of the step before `[L, 1]`.
        restarted: lanes whose episode starts with this step `[L]`; they always draw.
        deviation: standard deviation σ.
        steps: mean number of steps a draw holds; each step ends one with probability 1 / `steps`.
        generator: source of the draws.
    """
    fresh = generator.normal(0.0, deviation, noise.shape).astype(np.float32)
    if steps == 1:
        return fresh
    ended = restarted[:, None] | (generator.random(noise.shape) < 1.0 / steps)
    return np.where(ended, fresh, noise)
