"""The transfer mask (Definition 2): where knowledge of the source task may be used in the next task."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from agents.task import BoolArray, FloatArray, IntArray


def at_default(masked_observation: FloatArray, default_block: tuple[float, ...]) -> BoolArray:
    """Whether no masked subtask is detected, `[B]`: every block is exactly the default block.

    Eq. (13), Ψ(s) = s̃, §3.3.1. By Eq. (12) the masked subtasks then pay no reward, so source and target agree.

    Args:
        masked_observation: the masked part of observations, Ψ(s), `[B, k * len(default_block)]`.
        default_block: state of a subtask that is not detected.
    """
    blocks = masked_observation.shape[1] // len(default_block)
    default = np.tile(np.asarray(default_block, np.float32), blocks)
    return (masked_observation == default).all(axis=1)


@dataclass(frozen=True)
class TransferMask:
    """Definition 2 for one pair of adjacent tasks, k = i - 1: transfer is prevented while a fresh subtask shows."""

    target: Any
    """Layout of the task that is trained, 𝒯_k."""
    source: Any
    """Layout of the task the guide knows, 𝒯_i."""
    default_block: tuple[float, ...]
    """State of a subtask that is not detected."""

    def allowed(self, observation: FloatArray) -> BoolArray:
        """Transfer condition, Eq. (13): `[B]` for observations `[B, d]` of the trained task."""
        return at_default(observation[:, self._masked], self.default_block)

    def shared(self, observation: FloatArray) -> FloatArray:
        """What the guide sees, Ξ(s) of Eq. (6): `[B, d_source]`."""
        return observation[:, self._shared]

    @cached_property
    def _shared(self) -> IntArray:
        return self.target.shared_columns(self.source)

    @cached_property
    def _masked(self) -> IntArray:
        return self.target.masked_columns(self.source)
