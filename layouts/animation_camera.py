"""The camera of an animation: perspective onto a panel, and its own flight from overview to engagement and back.

Kilometres, +z up; panels are measured in pixels of a 1280 x 720 picture, +y up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from layouts.cameras import FIELD_OF_VIEW_RAD

Points = NDArray[np.float64]

NEAR_KM = 1.0
CLOSEST_KM = 75.0
"""Distance the camera keeps at least: what it looks at shall be seen with some ground around it."""

FILLED = 0.6
"""Share of a panel that the action fills."""

SMOOTH_S = 0.9
"""Standard deviation of the smoothing of the camera's flight, in seconds of the picture."""


@dataclass(frozen=True)
class Panel:
    """A part of the picture [pixels]."""

    left: float
    bottom: float
    width: float
    height: float


@dataclass(frozen=True)
class Pose:
    """Where the camera stands: `distance_km` from its target, `tilt_rad` above the horizon, turned by `yaw_rad`."""

    target_km: Points
    distance_km: float
    yaw_rad: float
    tilt_rad: float


@dataclass(frozen=True)
class Camera:
    """A pose that looks at a panel."""

    eye_km: Points
    basis: Points
    """[3, 3] rows: right, up, ahead."""
    focal: float
    """Pixels per unit of tangent."""
    middle: Points

    def see(self, points_km: Points) -> Points:
        """Points [..., 3] as right, up, depth [..., 3] of the eye."""
        return (points_km - self.eye_km) @ self.basis.T

    def place(self, seen: Points) -> Points:
        """What the eye sees [..., 3] on the panel [..., 2]; NaN where it is behind the eye."""
        depth = np.where(seen[..., 2:] > NEAR_KM, seen[..., 2:], np.nan)
        return self.middle + self.focal * seen[..., :2] / depth

    def screen(self, points_km: Points) -> Points:
        """Points [..., 3] on the panel [..., 2]; NaN where they are behind the eye."""
        return self.place(self.see(points_km))

    def outline(self, corners_km: Points) -> Points:
        """A convex polygon [N, 3] on the panel [M, 2], cut where it passes behind the eye."""
        seen, kept = self.see(corners_km), []
        for here, following in zip(seen, np.roll(seen, -1, axis=0), strict=True):
            if here[2] > NEAR_KM:
                kept.append(here)
            if (here[2] > NEAR_KM) != (following[2] > NEAR_KM):
                share = (1.001 * NEAR_KM - here[2]) / (following[2] - here[2])
                kept.append(here + share * (following - here))
        return self.place(np.array(kept).reshape(-1, 3))


def camera(pose: Pose, panel: Panel) -> Camera:
    """The camera that a pose stands for."""
    flat = math.cos(pose.tilt_rad)
    away = np.array([math.sin(pose.yaw_rad) * flat, -math.cos(pose.yaw_rad) * flat, math.sin(pose.tilt_rad)])
    right = np.array([math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), 0.0])
    basis = np.stack([right, np.cross(away, right), -away])
    middle = np.array([panel.left + panel.width / 2, panel.bottom + panel.height / 2])
    focal = panel.height / 2 / math.tan(FIELD_OF_VIEW_RAD / 2)
    return Camera(pose.target_km + away * pose.distance_km, basis, focal, middle)


def fit(points_km: Points, yaw_rad: float, tilt_rad: float, panel: Panel, room: float = 0.92) -> Pose:
    """The pose from this direction in which all points [N, 3] just fit into the middle of the panel."""
    target, low = points_km.mean(axis=0), 0.0
    for _round in range(5):
        low, high = 5.0, 6000.0
        for _halving in range(26):
            low, high = (low, (low + high) / 2) if _fits(points_km, target, low, high, yaw_rad, tilt_rad, panel, room) \
                else ((low + high) / 2, high)  # fmt: skip
        view = camera(Pose(target, high, yaw_rad, tilt_rad), panel)
        places = view.screen(points_km)
        across, up = ((places.min(axis=0) + places.max(axis=0)) / 2 - view.middle) * high / view.focal
        target = target + across * view.basis[0] + up * view.basis[1]
        low = high
    return Pose(target, low, yaw_rad, tilt_rad)


def _fits(
    points_km: Points, target: Points, low: float, high: float, yaw: float, tilt: float, panel: Panel, room: float
) -> bool:
    places = camera(Pose(target, (low + high) / 2, yaw, tilt), panel).screen(points_km)
    if not np.isfinite(places).all():
        return False
    spread = places.max(axis=0) - places.min(axis=0)
    return bool(spread[0] < room * panel.width and spread[1] < room * panel.height)


def camera_flight(overview: Pose, action: Sequence[Points | None], panel: Panel, frames_per_s: float) -> list[Pose]:
    """One pose a frame: the overview, and close to the action [N, 3] while there is some, without haste between."""
    poses = [overview if points is None else _close(points, overview, panel) for points in action]
    columns = np.array([(*pose.target_km, math.log(pose.distance_km)) for pose in poses])
    width = SMOOTH_S * frames_per_s
    reach = math.ceil(3 * width)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    padded = np.pad(columns, ((reach, reach), (0, 0)), mode="edge")
    smooth = np.stack([np.convolve(column, kernel / kernel.sum(), mode="valid") for column in padded.T], axis=1)
    return [Pose(row[:3], math.exp(row[3]), overview.yaw_rad, overview.tilt_rad) for row in smooth]


def _close(points_km: Points, overview: Pose, panel: Panel) -> Pose:
    """Towards the middle of the points, so near that they fill most of the panel."""
    view = camera(overview, panel)
    middle = (points_km.min(axis=0) + points_km.max(axis=0)) / 2
    across, up = np.ptp(points_km @ view.basis[:2].T, axis=0)
    distance = view.focal / FILLED * max(across / panel.width, up / panel.height)
    nearest = min(CLOSEST_KM, overview.distance_km)
    return Pose(middle, float(np.clip(distance, nearest, overview.distance_km)), overview.yaw_rad, overview.tilt_rad)
