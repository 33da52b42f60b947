"""Where to look at a flight scene from: all of it, straight down, or over an evader's shoulder; kilometres, +z up."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from layouts.motion import Motion

FIELD_OF_VIEW_RAD = math.radians(38.0)
"""Vertical."""

OVERVIEW_TILT_RAD = math.radians(56.0)
TOP_TILT_RAD = math.radians(89.5)
"""Not quite straight down: there the image could turn any way."""

HEADROOM_KM = 34.0
BEHIND_KM = 42.0
ABOVE_KM = 17.0
AHEAD_KM = 12.0
FOOT = 0.72
"""How far below the middle of the view the front edge is set, of half the height: the room above is for read-outs."""

LOOKBACK_S = 26.0

Vector = NDArray[np.float64]


def overview(width_km: float, depth_km: float, aspect: float, top: bool = False) -> tuple[Vector, Vector]:
    """Camera position and target that show all battlefields.

    Args:
        width_km: extent of all battlefields along x.
        depth_km: extent along y.
        aspect: width over height of the view.
        top: look straight down.
    """
    tilt = TOP_TILT_RAD if top else OVERVIEW_TILT_RAD
    half_view = math.tan(FIELD_OF_VIEW_RAD / 2)
    near = depth_km / 2 * math.cos(tilt)  # the front edge is closer than the middle, and so looks wider
    wide = width_km * 1.03 / 2 / (half_view * max(aspect, 0.5)) + near
    high = (depth_km * math.sin(tilt) + HEADROOM_KM * math.cos(tilt)) * 1.06 / 2 / half_view + near
    target = np.array([0.0, 0.0, 8.0 if top else 12.0])
    backward = np.array([0.0, -math.cos(tilt), math.sin(tilt)])
    shift = _shift(target, max(wide, high) * backward, depth_km)
    return target + shift + max(wide, high) * backward, target + shift


def _shift(target: Vector, back: Vector, depth_km: float) -> Vector:
    """What moves the view upwards until the front edge of the battlefields stands at its foot."""
    distance = float(np.linalg.norm(back))
    forward = -back / distance
    up = np.cross([1.0, 0.0, 0.0], forward)
    edge = np.array([0.0, -depth_km / 2, 0.0]) - target - back
    return max(0.0, edge @ up + FOOT * (edge @ forward) * math.tan(FIELD_OF_VIEW_RAD / 2)) * up


def chase(evader: Motion, time_s: float) -> tuple[Vector, Vector]:
    """Camera position and target behind and above an evader, along the way it has come lately."""
    here = evader.position(time_s)
    # Looking back over half a minute keeps the camera calm while the evader turns hard.
    along = evader.position(time_s + 4.0) - evader.position(time_s - LOOKBACK_S)
    along[2] = 0.0
    length = float(np.linalg.norm(along))
    direction = along / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    return here - direction * BEHIND_KM + np.array([0.0, 0.0, ABOVE_KM]), here + direction * AHEAD_KM
