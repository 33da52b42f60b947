"""Eq. (18): the composite policy with probability ε, the policy in training with probability 1 - ε."""

from __future__ import annotations

import numpy as np
import pytest

from agents.reuse import behaviour_action, draw_reuse

LANES = 20_000
NONE = np.zeros(LANES, bool)


def test_hand_written() -> None:
    own, composite = np.array([[0.1], [0.2]]), np.array([[-0.1], [-0.2]])
    assert behaviour_action(own, composite, np.array([True, False])).tolist() == [[-0.1], [0.2]]


@pytest.mark.parametrize("segment_steps", [1, 60])
def test_the_share_of_reuse_is_epsilon_per_step_and_per_segment(segment_steps: int) -> None:
    generator = np.random.default_rng(0)
    reused, shares = NONE, []
    restarted = ~NONE
    for _ in range(50):
        reused = draw_reuse(reused, restarted, 0.3, segment_steps, generator)
        restarted = NONE
        shares.append(reused.mean())
    assert np.mean(shares) == pytest.approx(0.3, abs=0.01)


def test_per_step_draws_are_independent_and_segments_last_sixty_steps() -> None:
    generator = np.random.default_rng(0)
    first = draw_reuse(NONE, ~NONE, 0.5, 1, generator)
    assert (draw_reuse(first, NONE, 0.5, 1, generator) != first).mean() == pytest.approx(0.5, abs=0.02)
    # A segment ends with probability 1/60, and half of the new draws fall on the same side.
    assert (draw_reuse(first, NONE, 0.5, 60, generator) != first).mean() == pytest.approx(1 / 120, abs=0.003)


def test_epsilon_zero_never_reuses_and_one_always() -> None:
    generator = np.random.default_rng(0)
    assert not draw_reuse(~NONE, ~NONE, 0.0, 60, generator).any()
    assert draw_reuse(NONE, ~NONE, 1.0, 60, generator).all()
