"""Inks of compared policies: the same policy has the same ink on every page and in every figure."""

from __future__ import annotations

from collections.abc import Sequence

from layouts.theme import FAILURE, NEUTRAL, POLICY_A, POLICY_B, missile_colour

FIXED = {"submas-target": POLICY_A, "expert-dragging": POLICY_B, "submas-chain": "#2aa8a0", "random": NEUTRAL}
"""The two that the Fly page shows first have its inks A and B."""
FREE = ("#b05cc6", "#7f8f1f", "#c4577a", "#5f7fb0", "#a0703c", "#4f9a5b")
"""Inks of all others, in the order in which they are chosen; about 3:1 on white and on dark, as all inks."""
CAUSES = {"left_field": FAILURE, "timeout": NEUTRAL, "not_finite": "#4a4f57", "shot_down": "#b86a6f"}


def policy_inks(policies: Sequence[str]) -> dict[str, str]:
    """Ink of every policy (a POLICY each)."""
    others = [policy for policy in policies if policy not in FIXED]
    return {policy: FIXED.get(policy) or FREE[others.index(policy) % len(FREE)] for policy in policies}


def cause_ink(cause: str) -> str:
    """Ink of a cause of failure: that of the missile, where it is one."""
    return CAUSES.get(cause) or missile_colour(int(cause.removeprefix("shot_down_")))


def cause_words(cause: str) -> str:
    """A cause of failure in words."""
    words = {
        "left_field": "left the field", "timeout": "out of time", "not_finite": "void", "shot_down": "shot down",
    }  # fmt: skip
    return words.get(cause) or f"shot down by missile {cause.removeprefix('shot_down_')}"
