"""Observation features: what a network sees of an observation in physical units.

Lengths are divided by fixed constants, angles become sine and cosine, and every subtask has a flag that says
whether it is detected. A block that shows the default vector becomes zeros with flag 0; no detected subtask
can look like that, because its sine and cosine lie on the unit circle.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from agents.task import BoolArray, FloatArray, IntArray, Layout


@dataclass(frozen=True)
class ObservationFeatures:
    """Turns observations `[B, d]` of one layout into network inputs `[B, size]`."""

    layout: Layout
    """Layout of the observations."""
    subtasks: tuple[int, ...]
    """Subtasks that have a block in the layout, ascending."""
    length_scales_m: Mapping[str, float]
    """Divisor [m] of every length, by the stem of its column (`r` for `r_3`); other columns are angles."""
    default_block: tuple[float, ...]
    """Block of a subtask that is not detected."""

    @property
    def size(self) -> int:
        """Number of network inputs: one per length, two per angle, one flag per subtask."""
        return len(self._lengths) + 2 * len(self._angles) + len(self.subtasks)

    @cached_property
    def digest(self) -> str:
        """12 hexadecimal digits that change with anything that alters the features."""
        facts = [list(self.layout.names), sorted(self.length_scales_m.items()), list(self.default_block)]
        return hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:12]

    def detected(self, observation: FloatArray) -> BoolArray:
        """Which subtasks are detected `[B, M]`: their block differs from the default block."""
        shape = (len(observation), len(self.subtasks), len(self.default_block))
        blocks = observation[:, self._block_columns].reshape(shape)
        return (blocks != np.asarray(self.default_block, np.float32)).any(axis=2)

    def encode(self, observation: FloatArray) -> FloatArray:
        """Network inputs `[B, size]`, float32, of observations `[B, d]` in this layout."""
        flags = self.detected(observation)
        # One column of ones stands for "always detected": the columns that belong to no subtask.
        shown = np.concatenate([flags, np.ones((len(observation), 1), bool)], axis=1)
        lengths = observation[:, self._lengths] * self._inverse_scales * shown[:, self._owner[self._lengths]]
        angles, seen = observation[:, self._angles], shown[:, self._owner[self._angles]]
        parts = [lengths, np.sin(angles) * seen, np.cos(angles) * seen, flags]
        return np.concatenate(parts, axis=1, dtype=np.float32)

    @cached_property
    def _lengths(self) -> IntArray:
        names = enumerate(self.layout.names)
        return np.array([column for column, name in names if stem(name) in self.length_scales_m], int)

    @cached_property
    def _angles(self) -> IntArray:
        return np.setdiff1d(np.arange(self.layout.size), self._lengths)

    @cached_property
    def _inverse_scales(self) -> FloatArray:
        names = [self.layout.names[i] for i in self._lengths]
        return np.array([1.0 / self.length_scales_m[stem(name)] for name in names], np.float32)

    @cached_property
    def _block_columns(self) -> IntArray:
        columns = np.arange(self.layout.size)
        return np.array([columns[self.layout.block(subtask)] for subtask in self.subtasks], int).ravel()

    @cached_property
    def _owner(self) -> IntArray:
        """Index of the subtask each column belongs to; the number of subtasks for shared columns."""
        owner = np.full(self.layout.size, len(self.subtasks))
        for index, subtask in enumerate(self.subtasks):
            owner[self.layout.block(subtask)] = index
        return owner


def stem(name: str) -> str:
    """Column name without its subtask number: `r_3` -> `r`."""
    head, _, tail = name.rpartition("_")
    return head if head and tail.isdigit() else name


def subtask_number(name: str) -> int:
    """Subtask a column belongs to, 0 for a shared column: `r_3` -> 3."""
    head, _, tail = name.rpartition("_")
    return int(tail) if head and tail.isdigit() else 0


def unseen_subtasks(known: Layout, present: Layout) -> tuple[int, ...]:
    """Subtasks of the layout `present` that a policy with layout `known` cannot see."""
    return tuple(sorted({subtask_number(name) for name in set(present.names) - set(known.names)}))


def adapt(observation: FloatArray, present: Layout, known: Layout, default_block: tuple[float, ...]) -> FloatArray:
    """Observations `[B, d]` of layout `present`, rewritten in a layout that knows at least its subtasks.

    Blocks that `present` lacks are filled with the default block: the subtask is never detected.
    """
    filled = np.empty((len(observation), known.size), np.float32)
    place = {name: column for column, name in enumerate(present.names)}
    for column, name in enumerate(known.names):
        if name in place:
            filled[:, column] = observation[:, place[name]]
        else:
            block = known.block(subtask_number(name))
            filled[:, column] = default_block[column - block.start]
    return filled
