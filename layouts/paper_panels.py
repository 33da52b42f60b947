"""What the paper's figures show, on pages and in pictures alike; nothing here draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

WIDTH = 0.38
"""Of one bar; tasks are 1 apart."""


@dataclass(frozen=True)
class Band:
    """One algorithm in one panel: its seeds, their summary over T times, and the interval of that."""

    algorithm: str
    label: str
    steps: Values
    """`[T]` environment steps."""
    value: Values
    low: Values
    high: Values
    """`[T]`; NaN where there is no interval."""
    seeds: tuple[tuple[Values, Values], ...]
    """Steps and values of every single seed."""
    seed_names: tuple[str, ...] = ()
    """How each of them is called where a pointer asks."""


@dataclass(frozen=True)
class Panel:
    """One task: what the algorithms reach in it."""

    title: str
    returns: tuple[Band, ...]
    success: tuple[Band, ...]


@dataclass(frozen=True)
class Bars:
    """One policy, or one per task, over all tasks; None where there is no number yet."""

    algorithm: str
    label: str
    returns: Sequence[float | None]
    success: Sequence[float | None]
    interval: Sequence[tuple[float, float] | None]
    """95 % interval of the success rate."""


@dataclass(frozen=True)
class AzimuthPanel:
    """One policy's engagement."""

    title: str
    time_s: NDArray[np.float64]
    """`[T]`."""
    azimuth_deg: dict[int, NDArray[np.float64]]
    """Missile -> `[T]` azimuth off the nose, left positive; NaN while it is not in flight."""
