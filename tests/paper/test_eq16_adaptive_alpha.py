"""Eq. (16): α = 1 - β."""

from __future__ import annotations

import pytest

from agents.weights import adaptive_alpha


@pytest.mark.parametrize(("beta", "alpha"), [(0.0, 1.0), (0.25, 0.75), (1.0, 0.0)])
def test_hand_computed(beta: float, alpha: float) -> None:
    assert adaptive_alpha(beta) == alpha
