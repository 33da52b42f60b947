"""What keeps learning steady while the guide fades: each remedy of the `fast` profile, and `fast` without it.

A collapse is a policy at 100 % that flies out of the field a few epochs later. The studies of `agents.trial` take one
remedy away at a time and train the same stage with the same seeds.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final

from agents.hyperparameters import FAST, Hyperparameters

FADE_EPOCHS: Final = 32
"""Epochs in which the guide fades from ε₀ to nothing at most, in a study: two and a half times as fast as in `fast`."""
STUDY: Final = dataclasses.replace(
    FAST,
    epochs=40,
    epsilon_clip=FAST.epsilon_start / FADE_EPOCHS,
    alpha_clip=1.0 / FADE_EPOCHS,
    promotion_success=2.0,
)
"""`fast`, but the stage goes on after it has been passed, and the guide is gone before it ends: falls can be seen."""


@dataclass(frozen=True)
class Remedy:
    """One remedy, and the profile that lacks it."""

    says: str
    """What is taken away, in a few words."""
    why: str
    """The cause of collapse that it is meant to remove."""
    without: Mapping[str, Any] = field(default_factory=dict)
    """Numbers of `STUDY` that are replaced."""

    @property
    def hyperparameters(self) -> Hyperparameters:
        """The study's numbers without this remedy."""
        return dataclasses.replace(STUDY, **self.without)


REMEDIES: Final[Mapping[str, Remedy]] = MappingProxyType(
    {
        "none": Remedy("nothing: all of `fast`", "the comparison for all others"),
        "one-step": Remedy(
            "returns of 1 step instead of 40",
            "the exit's value has a thousand steps to travel, one update at a time",
            {"return_steps": 1},
        ),
        "ten-step": Remedy("returns of 10 steps instead of 40", "the same, ten at a time", {"return_steps": 10}),
        "slow-targets": Remedy(
            "targets that follow in 200 updates (τ 0.005) instead of 50",
            "values are learned from stale values",
            {"polyak": 0.005},
        ),
        "haste": Remedy("γ 0.998 instead of 0.9995", "discounting the exit pays for haste with risk", {"gamma": 0.998}),
        "short-sight": Remedy("γ 0.99 as in Table 2", "an exit 600 steps away is worth nothing", {"gamma": 0.99}),
        "no-norm": Remedy(
            "critics without layer normalisation", "values grow without bound off the data", {"layer_norm": False}
        ),
        "one-return": Remedy(
            "one return, r + α r^d, in place of two",
            "every change of α makes all learned values wrong",
            {"two_returns": False},
        ),
        "no-average": Remedy(
            "the actor itself in place of its moving average", "single updates swing the policy", {"actor_average": 0.0}
        ),
        "every-step": Remedy(
            "ε drawn at every step instead of every 60",
            "the guide corrects each error at once; the policy never sees its own states",
            {"segment_steps": 1},
        ),
    }
)
"""Remedies by name; `none` takes nothing away."""
