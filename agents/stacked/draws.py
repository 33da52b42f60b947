"""Random numbers by counting: a hash of (seed, purpose, count, place), the same on every device.

A generator with a state would make an agent's numbers depend on who is stacked with it, and would have to be registered
with every CUDA graph. A count is an ordinary tensor.
"""

from __future__ import annotations

import math
from enum import IntEnum
from typing import Final

import torch
from torch import Tensor

_GOLDEN: Final = 0x9E3779B97F4A7C15 - 2**64
_FIRST: Final = 0xBF58476D1CE4E5B9 - 2**64
_SECOND: Final = 0x94D049BB133111EB - 2**64


class Purpose(IntEnum):
    """What numbers are drawn for; each purpose has a stream of its own."""

    TRANSITIONS = 1
    """Which transitions a batch is made of; counted in updates."""
    TARGET_NOISE = 2
    """Target policy smoothing; counted in updates."""
    SEGMENT = 3
    """Whether a draw of ε ends, and the next one (Eq. 18); counted in steps of all lanes."""
    NOISE = 4
    """Exploration noise; counted in steps of all lanes."""
    NOISE_END = 5
    """Whether a draw of the noise ends; counted in steps of all lanes."""


def uniform(seeds: Tensor, purpose: Purpose, counts: Tensor, shape: tuple[int, ...]) -> Tensor:
    """Numbers in (0, 1), float64 `[S, *shape]`: SplitMix64 (Steele 2014), one key per agent.

    Args:
        seeds: one seed per agent, int64 `[S]`.
        purpose: what they are for.
        counts: how often this purpose was drawn for before, int64 `[S]`.
        shape: numbers per agent.
    """
    key = _mix(_mix(seeds + _wrapped(_GOLDEN * purpose)) + _GOLDEN * (counts + 1))
    places = torch.arange(1, math.prod(shape) + 1, device=seeds.device)
    bits = _shifted(_mix(key[:, None] + _GOLDEN * places), 11)
    return ((bits.double() + 0.5) * 2.0**-53).view(len(seeds), *shape)


def normal(seeds: Tensor, purpose: Purpose, counts: Tensor, shape: tuple[int, ...]) -> Tensor:
    """Standard normal numbers, float64 `[S, *shape]`, by Box and Muller; arguments as in `uniform`."""
    radius, turn = uniform(seeds, purpose, counts, (2, *shape)).unbind(dim=1)
    return (-2.0 * radius.log()).sqrt() * (2.0 * math.pi * turn).cos()


def _wrapped(value: int) -> int:
    """A whole number as the int64 that has its last 64 bits."""
    return (value + 2**63) % 2**64 - 2**63


def _mix(z: Tensor) -> Tensor:
    # Products of int64 wrap around, as those of the unsigned original do.
    z = (z ^ _shifted(z, 30)) * _FIRST
    z = (z ^ _shifted(z, 27)) * _SECOND
    return z ^ _shifted(z, 31)


def _shifted(z: Tensor, places: int) -> Tensor:
    """Shift to the right that brings in zeros; torch's own brings in the sign."""
    return (z >> places) & (2 ** (64 - places) - 1)
