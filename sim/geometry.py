"""Angles of an engagement seen from above; radians in (-pi, pi], counter-clockwise positive."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def wrap_to_pi(angle_rad: ArrayLike) -> NDArray[Any]:
    """The same angle in (-pi, pi], any shape [rad]."""
    angle = np.asarray(angle_rad)
    return angle - 2.0 * np.pi * np.ceil((angle - np.pi) / (2.0 * np.pi))


def azimuth(from_xy_m: NDArray, heading_rad: ArrayLike, to_xy_m: NDArray) -> NDArray[Any]:
    """Direction to a point relative to the nose [rad], left positive; points `[..., 2]` in metres."""
    offset = np.asarray(to_xy_m) - np.asarray(from_xy_m)
    return wrap_to_pi(np.arctan2(offset[..., 1], offset[..., 0]) - np.asarray(heading_rad))
