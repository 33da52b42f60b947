"""Learning curves of all seeds of one algorithm brought to common times and summarised (Fig. 8, 9)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from agents.statistics import Interval, bootstrap
from workbench.reproduce.result_set import Curve

Values = NDArray[np.float64]
Quantity = Literal["success_rate", "mean_return"]


def common_steps(curves: Sequence[Curve]) -> NDArray[np.float64]:
    """Every time `[T]` at which some seed was evaluated, ascending [environment steps]."""
    return np.unique(np.concatenate([np.array(curve.env_steps, dtype=np.float64) for curve in curves]))


def at_steps(curve: Curve, quantity: Quantity, steps: Values) -> Values:
    """A seed's curve at these times `[T]`: the latest evaluation counts.

    Before the first one it is that first one; behind its end, when the stage is over, the last: that policy is kept.
    """
    index = np.searchsorted(np.array(curve.env_steps, dtype=np.float64), steps, side="right") - 1
    return np.array(getattr(curve, quantity), dtype=np.float64)[np.maximum(index, 0)]


def summary(curves: Sequence[Curve], quantity: Quantity) -> tuple[Values, Interval]:
    """Times `[T]`, and the interquartile mean over the seeds with its 95 % bootstrap interval at each of them."""
    steps = common_steps(curves)
    runs = np.stack([at_steps(curve, quantity, steps) for curve in curves], axis=-1)
    return steps, bootstrap([runs])
