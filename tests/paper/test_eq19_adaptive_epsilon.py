"""Eq. (19): ε = ε₀ (1 - β)."""

from __future__ import annotations

import pytest

from agents.weights import adaptive_epsilon


@pytest.mark.parametrize(("beta", "epsilon"), [(0.0, 0.8), (0.5, 0.4), (1.0, 0.0)])
def test_hand_computed(beta: float, epsilon: float) -> None:
    assert adaptive_epsilon(beta, 0.8) == pytest.approx(epsilon)
