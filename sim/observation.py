"""Observation vectors of Table 1 as named columns, and the two inter-task maps of Eq. 5-6 (Xi and Psi)."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

OWN_NAMES = ("x", "y", "psi", "l", "theta_AA", "theta_ATA", "phi_exit")
"""Columns every task has (Table 1): position [m], yaw [rad], range to the interceptor [m], three angles [rad]."""

UNLAUNCHED = (-1.0, -math.pi)
"""Default block [r_m, phi_m] of a missile that is not in flight (section 2.3): outside the legal r >= 0, phi > -pi."""

BLOCK = len(UNLAUNCHED)


@dataclass(frozen=True)
class ObservationLayout:
    """Which missiles an observation describes, in ascending order (Table 1).

    Eq. (5): against the layout of a source task its columns fall into shared and masked ones.
    """

    missiles: tuple[int, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Column names in order, for example `("x", ..., "phi_exit", "r_1", "phi_1")`."""
        return _names(self.missiles)

    @property
    def size(self) -> int:
        """Number of columns d = 7 + 2 n."""
        return len(OWN_NAMES) + BLOCK * len(self.missiles)

    @property
    def digest(self) -> str:
        """Twelve hex digits that identify the columns; policy files carry them."""
        return hashlib.sha256(",".join(self.names).encode()).hexdigest()[:12]

    def block(self, missile: int) -> slice:
        """Columns [r, phi] of one missile.

        Raises:
            ValueError: the missile is not part of this layout.
        """
        start = len(OWN_NAMES) + BLOCK * self.missiles.index(missile)
        return slice(start, start + BLOCK)

    def shared_columns(self, source: ObservationLayout) -> NDArray[np.intp]:
        """Columns of this layout that the source task keeps, in the source's order (the map Xi, Eq. 6)."""
        return np.array([self.names.index(name) for name in source.names], dtype=np.intp)

    def masked_columns(self, source: ObservationLayout) -> NDArray[np.intp]:
        """Columns of this layout that the source task masks (the map Psi, Eq. 6)."""
        kept = set(source.names)
        return np.array([i for i, name in enumerate(self.names) if name not in kept], dtype=np.intp)


def keep_shared(observation: NDArray, target: ObservationLayout, source: ObservationLayout) -> NDArray:
    """Xi of Eq. (6): the part of target observations `[B, d]` that the source task sees, `[B, d_source]`."""
    return observation[:, target.shared_columns(source)]


def keep_masked(observation: NDArray, target: ObservationLayout, source: ObservationLayout) -> NDArray:
    """Psi of Eq. (6): the part of target observations `[B, d]` that belongs to masked missiles, `[B, 2 k]`."""
    return observation[:, target.masked_columns(source)]


def is_default(masked: NDArray) -> NDArray[np.bool_]:
    """Whether masked blocks `[B, 2 k]` all equal the default vector: the condition of Eq. (12), `[B]`.

    The comparison is exact: the kernel writes these very float32 values, so no tolerance is needed.
    """
    default = np.tile(np.asarray(UNLAUNCHED, dtype=np.float32), masked.shape[1] // BLOCK)
    return (masked.astype(np.float32) == default).all(axis=1)


@cache  # a policy asks at every step
def _names(missiles: tuple[int, ...]) -> tuple[str, ...]:
    return OWN_NAMES + tuple(f"{kind}_{m}" for m in missiles for kind in ("r", "phi"))
