"""A flight that is being flown just now, in a viser scene: its bodies and the ways they have come; km, +z up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.battlefield import EXAGGERATION, draw_lines, drawing_scale
from layouts.meshes import aircraft, missile
from layouts.motion import KM, Motion, quaternions, segments
from layouts.scene import AIRCRAFT_KM, MISSILE_KM
from layouts.theme import INTERCEPTOR, Ground, Rgb, missile_colour, scene_ink
from sim.scenario import Battlefield

POINT_S = 1.0
"""Spacing of the points kept of a way."""
NOWHERE = np.zeros(3)


@dataclass(frozen=True)
class Pose:
    """Where a body is and how it lies."""

    position_m: NDArray[np.float64]
    """`[3]` x, y, altitude."""
    heading_rad: float
    pitch_rad: float
    bank_rad: float


@dataclass
class _Body:
    """Handles of one body, and the points of its way so far."""

    mesh: Any
    way: Any
    times_s: list[float] = field(default_factory=list)
    points_km: list[NDArray[np.float64]] = field(default_factory=list)


class LiveBodies:
    """Bodies by name (evader, interceptor, missile_k), each made when it first flies.

    Args:
        server: the server of the scene.
        name: prefix of all names in the scene.
        colour: `#rrggbb` of the evader.
        look: dark or light ground.
        place: the battlefield and where it lies in the scene, `[3]` km.
    """

    def __init__(
        self, server: viser.ViserServer, name: str, colour: str, look: Ground, place: tuple[Battlefield, NDArray]
    ) -> None:
        self._server, self._name, self._colour, self._look = server, name, colour, look
        battlefield, self._offset_km = place
        self._scale = drawing_scale(battlefield)
        self._bodies: dict[str, _Body] = {}

    @property
    def evader(self) -> Motion | None:
        """The way of the evader so far, for cameras; None before anything was shown."""
        body = self._bodies.get("evader")
        if body is None:
            return None
        points = np.array(body.points_km)
        return Motion(np.array(body.times_s), points, np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1)))

    def show(self, time_s: float, poses: Mapping[str, Pose]) -> None:
        """Place the bodies that fly at this time [s] and hide the others; times go forward."""
        with self._server.atomic():
            for name, pose in poses.items():
                body = self._bodies.get(name) or self._add(name)
                self._place(body, time_s, pose)
            for name, body in self._bodies.items():
                if body.mesh.visible != (name in poses):
                    body.mesh.visible = name in poses

    def _place(self, body: _Body, time_s: float, pose: Pose) -> None:
        position = pose.position_m * np.array([KM, KM, KM * EXAGGERATION]) + self._offset_km
        angles = (np.array([angle]) for angle in (pose.heading_rad, pose.pitch_rad, pose.bank_rad))
        body.mesh.position, body.mesh.wxyz = position, quaternions(*angles)[0]
        if body.times_s and time_s < body.times_s[-1] + POINT_S:
            return
        body.times_s.append(time_s)
        body.points_km.append(position)
        if len(body.points_km) > 1:
            body.way.points = segments(np.array(body.points_km))
            body.way.visible = True

    def _add(self, name: str) -> _Body:
        ink, mesh, size_km = self._shape(name)
        shape = self._server.scene.add_mesh_simple(
            f"{self._name}/{name}", mesh.vertices * size_km * self._scale, mesh.faces, color=ink, flat_shading=True,
            side="double", cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        way = draw_lines(self._server, f"{self._name}/{name}_way", np.zeros((1, 2, 3)), ink, 3.2, NOWHERE)
        way.visible = False
        self._bodies[name] = body = _Body(shape, way)
        return body

    def _shape(self, name: str) -> tuple[Rgb, Any, float]:
        if name.startswith("missile_"):
            return scene_ink(missile_colour(int(name.removeprefix("missile_"))), self._look), missile(), MISSILE_KM
        colour = self._colour if name == "evader" else INTERCEPTOR
        return scene_ink(colour, self._look), aircraft(), AIRCRAFT_KM
