"""Eq. (20): α moves by at most δ_α per epoch."""

from __future__ import annotations

import pytest

from agents.weights import clip_change, next_alpha


@pytest.mark.parametrize(("wanted", "previous", "clipped"), [(0.0, 1.0, 0.99), (1.0, 0.5, 0.51), (0.495, 0.5, 0.495)])
def test_hand_computed(wanted: float, previous: float, clipped: float) -> None:
    assert clip_change(wanted, previous, 0.01) == pytest.approx(clipped)


def test_full_success_takes_a_hundred_epochs_to_switch_distillation_off() -> None:
    alpha, epochs = 1.0, 0
    while alpha > 1e-9:
        alpha, epochs = next_alpha(alpha, 1.0, 0.01, "adaptive", epochs, 300), epochs + 1
    assert epochs == 100


def test_alpha_comes_back_when_success_is_lost() -> None:
    assert next_alpha(0.2, 0.0, 0.01, "adaptive", 5, 300) == pytest.approx(0.21)


def test_a_decayed_alpha_ignores_success() -> None:
    assert [next_alpha(0.5, beta, 0.01, "decayed", 75, 300) for beta in (0.0, 1.0)] == [0.75, 0.75]
    assert next_alpha(0.5, 0.0, 0.01, "decayed", 300, 300) == 0.0
