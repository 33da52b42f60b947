"""Tracks as motions in a scene: kilometres, exaggerated altitude, quaternions, at any time asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.trajectory import BodyTrack, MissileTrack

KM = 1e-3
SAMPLE_S = 0.25
"""Spacing of the samples kept; positions between them are interpolated."""


@dataclass(frozen=True)
class Motion:
    """Where a body is in a scene, over the N samples at which it is in flight."""

    time_s: NDArray[np.float64]
    """[N], ascending."""
    position_km: NDArray[np.float64]
    """[N, 3] in scene coordinates."""
    wxyz: NDArray[np.float64]
    """[N, 4] unit quaternions, body to scene."""

    @property
    def flies(self) -> bool:
        """Whether there is a sample at all; a missile that was never launched has none."""
        return len(self.time_s) > 0

    def position(self, time_s: float | NDArray[np.floating]) -> NDArray[np.float64]:
        """Position [..., 3] at any time, held at both ends."""
        axes = [np.interp(time_s, self.time_s, self.position_km[:, axis]) for axis in range(3)]
        return np.stack(axes, axis=-1)

    def attitude(self, time_s: float) -> NDArray[np.float64]:
        """Quaternion [4] of the nearest sample."""
        index = int(np.searchsorted(self.time_s, time_s).clip(0, len(self.time_s) - 1))
        return self.wxyz[index]

    def heading(self, time_s: float) -> float:
        """Where the nose points on the ground [rad], in (-pi, pi], 0 along +x and left positive."""
        w, x, y, z = self.attitude(time_s)
        return float(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))

    def tail(self, time_s: float, length_s: float, points: int) -> NDArray[np.float64]:
        """The last `length_s` before a time as `points` - 1 line segments [points - 1, 2, 3]."""
        return segments(self.position(self.tail_times(time_s, length_s, points)))

    def tail_times(self, time_s: float, length_s: float, points: int) -> NDArray[np.float64]:
        """The times [points] at the ends of those segments."""
        end = min(time_s, float(self.time_s[-1]))
        return np.linspace(max(end - length_s, float(self.time_s[0])), end, points)


def motion(
    track: BodyTrack | MissileTrack,
    time_s: NDArray[np.floating],
    exaggeration: float,
    offset_km: NDArray[np.floating],
) -> Motion:
    """The motion of one track: altitude times `exaggeration`, moved by `offset_km` [3]."""
    flown = np.flatnonzero(np.isfinite(track.position_m[:, 0]))
    step = max(1, round(SAMPLE_S / _spacing(time_s)))
    kept = np.union1d(flown[::step], flown[-1:])
    scale = np.array([KM, KM, KM * exaggeration])
    bank = track.bank_rad if isinstance(track, BodyTrack) else np.zeros(len(time_s))
    wxyz = quaternions(track.heading_rad[kept], track.pitch_rad[kept], bank[kept])
    return Motion(time_s[kept].astype(float), track.position_m[kept] * scale + offset_km, wxyz)


def quaternions(
    heading_rad: NDArray[np.floating], pitch_rad: NDArray[np.floating], bank_rad: NDArray[np.floating]
) -> NDArray[np.float64]:
    """Attitudes [N, 4] (w, x, y, z): nose turned left by heading and up by pitch, left wing down by bank."""
    yaw, pitch, roll = (
        np.asarray(angle, dtype=float) / 2.0 for angle in (heading_rad, -np.asarray(pitch_rad), -np.asarray(bank_rad))
    )
    cy, sy, cp, sp, cr, sr = (
        np.cos(yaw),
        np.sin(yaw),
        np.cos(pitch),
        np.sin(pitch),
        np.cos(roll),
        np.sin(roll),
    )
    w = cr * cp * cy + sr * sp * sy
    x = sr * cp * cy - cr * sp * sy
    y = cr * sp * cy + sr * cp * sy
    z = cr * cp * sy - sr * sp * cy
    return np.stack([w, x, y, z], axis=-1)


def segments(points: NDArray[np.floating]) -> NDArray[np.float64]:
    """A polyline [N, 3] as line segments [N - 1, 2, 3]."""
    return np.stack([points[:-1], points[1:]], axis=1).astype(float)


def _spacing(time_s: NDArray[np.floating]) -> float:
    return float(np.median(np.diff(time_s))) if len(time_s) > 1 else SAMPLE_S
