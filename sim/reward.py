"""The reward as a vector of terms: goal, missile 1..M, time (Eq. 9), and what masking removes (Eq. 10-12).

The kernel writes the terms; these functions state what the equations say of them. Being shot down by missile i belongs
to subtask i, leaving the battlefield and the exit belong to the final goal, and the step's cost is nobody's.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

GOAL = 0
"""Column of the final goal's term."""


def total_reward(terms: NDArray) -> NDArray:
    """Eq. (9): the reward of the target task is the sum of its terms `[..., M + 2]` -> `[...]`."""
    return terms.sum(axis=-1)


def source_reward(terms: NDArray, masked: Iterable[int]) -> NDArray:
    """Eq. (10): the reward of the source task in which missiles are masked, `[..., M + 2]` -> `[...]`."""
    return total_reward(terms) - masked_reward(terms, masked)


def masked_reward(terms: NDArray, masked: Iterable[int]) -> NDArray:
    """Eq. (11): the terms of the masked missiles, summed; by Eq. (12) zero while none of them has appeared."""
    columns = np.array(sorted(masked), dtype=np.intp)
    return terms[..., columns].sum(axis=-1)
