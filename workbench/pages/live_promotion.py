"""The rule by which a stage is passed, in words, and how near its policy is to it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from agents.hyperparameters import Hyperparameters

_WHOLE = 1e-6
_LEAST_AFTER_PASS = 0.9
"""A policy that has passed one evaluation does not lose every tenth episode of the next: less than once in 10⁵."""


@dataclass(frozen=True)
class Passed:
    """How many of the evaluations that a policy needs in a row it has passed: at least, at most."""

    least: int
    most: int

    def words(self, needed: int) -> str:
        """For a person, of `needed` evaluations."""
        count = str(self.least) if self.least == self.most else f"{self.least} or {self.most}"
        if self.most - self.least > 1:
            count = f"{self.least} to {self.most}"
        return f"{count} of {needed} passed"


def never_promotes(hyper: Hyperparameters) -> bool:
    """Whether a stage always takes all of its epochs."""
    return hyper.promotion_success > 1.0


def rule_words(hyper: Hyperparameters) -> str:
    """When a stage ends, in words."""
    if never_promotes(hyper):
        return f"all {hyper.epochs} epochs; the best policy is kept"
    needed, episodes = hyper.promotion_evaluations, hyper.evaluation_episodes
    windows = f"{needed} windows" if needed > 1 else "one window"
    return f"{windows} of {episodes} episodes ≥ {percent_short(hyper.promotion_success)}"


def percent_short(share: float) -> str:
    """A share as a percentage without needless decimals: 99 %, 98.5 %."""
    return f"{100 * share:.1f}".removesuffix(".0") + " %"


def passed(rate: float, length_mean_s: float, hyper: Hyperparameters) -> Passed:
    """How many evaluations the latest policy has passed, of those pooled in its success rate.

    `agents.promotion.examine` flies one evaluation after the other while they pass, and a metrics row has their mean.
    How many there were follows from it, as successes and lengths [s] are whole numbers, not always to the last one.

    Args:
        rate: success over all episodes of the latest policy's evaluations, 0..1.
        length_mean_s: their mean length [s]; NaN where it is not known.
        hyper: the rule.
    """
    needed, episodes = hyper.promotion_evaluations, hyper.evaluation_episodes
    counts = [
        count
        for flown in range(1, needed + 1)
        if _whole(rate * episodes * flown) and _whole(length_mean_s * episodes * flown)
        for count in _possible(round(rate * episodes * flown), flown, hyper)
    ]
    return Passed(min(counts), max(counts)) if counts else Passed(0, needed)


def _possible(successes: int, flown: int, hyper: Hyperparameters) -> list[int]:
    """Passed evaluations that fit so many successes in `flown` of them, of which only the last may have failed."""
    episodes = hyper.evaluation_episodes
    least = math.ceil(hyper.promotion_success * episodes - _WHOLE)
    counts = []
    floor = math.ceil(_LEAST_AFTER_PASS * episodes) if flown > 1 else 0
    if (flown - 1) * least + floor <= successes <= (flown - 1) * episodes + least - 1:
        counts.append(flown - 1)
    if flown == hyper.promotion_evaluations and flown * least <= successes <= flown * episodes:
        counts.append(flown)
    return counts


def _whole(value: float) -> bool:
    return math.isnan(value) or abs(value - round(value)) < max(_WHOLE, 1e-9 * abs(value))
