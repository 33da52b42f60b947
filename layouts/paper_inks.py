"""Ink of each algorithm in the paper's figures, on pages and in pictures alike."""

from __future__ import annotations

from layouts.theme import FAILURE, NEUTRAL, POLICY_A, POLICY_B, SUCCESS, missile_colour

INKS = {
    "submas": POLICY_A,
    "wo-pd": FAILURE,
    "wo-pr": missile_colour(1),
    "dec-pd": SUCCESS,
    "dec-pr": POLICY_B,
    "td3": POLICY_B,
    "ppo": missile_colour(1),
    "sac": SUCCESS,
    "expert": SUCCESS,
}
"""Ink of an algorithm; blue and green for SubMas-RL and the expert are the paper's own (Fig. 13)."""


def ink(algorithm: str) -> str:
    """Ink of an algorithm; grey for one without."""
    return INKS.get(algorithm, NEUTRAL)
