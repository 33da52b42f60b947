"""Eq. (21): ε moves by at most δ_ε per epoch."""

from __future__ import annotations

import pytest

from agents.weights import next_epsilon


def test_hand_computed() -> None:
    assert next_epsilon(0.8, 1.0, 0.8, 0.01, "adaptive", 1, 300) == pytest.approx(0.79)
    assert next_epsilon(0.3, 0.0, 0.8, 0.01, "adaptive", 1, 300) == pytest.approx(0.31)
    assert next_epsilon(0.4, 0.5, 0.8, 0.01, "adaptive", 1, 300) == pytest.approx(0.4)


def test_full_success_takes_eighty_epochs_to_switch_reuse_off() -> None:
    epsilon, epochs = 0.8, 0
    while epsilon > 1e-9:
        epsilon, epochs = next_epsilon(epsilon, 1.0, 0.8, 0.01, "adaptive", epochs, 300), epochs + 1
    assert epochs == 80


def test_a_decayed_epsilon_falls_linearly_from_its_start() -> None:
    assert next_epsilon(0.8, 0.0, 0.8, 0.01, "decayed", 150, 300) == pytest.approx(0.4)
