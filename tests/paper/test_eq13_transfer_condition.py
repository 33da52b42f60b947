"""Eq. (13): transfer is allowed exactly where the masked part of the state equals the default vector."""

from __future__ import annotations

import math

import numpy as np

from agents.transfer_mask import at_default

DEFAULT = (-1.0, -math.pi)


def test_hand_written_blocks() -> None:
    masked = np.array(
        [
            [-1.0, -math.pi, -1.0, -math.pi],
            [-1.0, -math.pi, 9_000.0, 0.5],
            [9_000.0, 0.5, -1.0, -math.pi],
            [-1.0, math.pi, -1.0, -math.pi],
        ],
        np.float32,
    )
    assert at_default(masked, DEFAULT).tolist() == [True, False, False, False]


def test_the_comparison_is_exact() -> None:
    near = np.array([[-1.0, np.nextafter(np.float32(-math.pi), np.float32(0))]], np.float32)
    assert not at_default(near, DEFAULT).any()


def test_nothing_masked_always_allows() -> None:
    assert at_default(np.empty((3, 0), np.float32), DEFAULT).all()
