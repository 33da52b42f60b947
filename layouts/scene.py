"""The 3-D replay in a viser scene (Fig. 10, 11): battlefields, bodies, trails, gates; kilometres, +z up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.battlefield import EXAGGERATION, add_battlefield, draw_lines, drawing_scale
from layouts.meshes import Mesh, aircraft, missile
from layouts.motion import KM, Motion, motion, segments
from layouts.theme import (
    FAILURE,
    INTERCEPTOR,
    Ground,
    Mode,
    Rgb,
    blend,
    ground,
    missile_colour,
    rgb,
    scene_ink,
)
from sim.trajectory import Trajectory
from sim.world import Fate, Outcome

GAP_KM = 14.0
TAIL_S = 75.0
TAIL_POINTS = 26
TAIL_LIFT_KM = 0.4
PATH_POINTS = 500
AIRCRAFT_KM = 10.0
MISSILE_KM = 8.0
BURST = (255, 150, 60)


@dataclass(frozen=True)
class Body:
    """One moving body: its motion and the handles that show it."""

    motion: Motion
    mesh: Any
    tail: Any
    drop: Any
    gone_after_s: float


@dataclass(frozen=True)
class Mark:
    """Something that appears at a time and stays: a missile's end, a shot-down evader."""

    time_s: float
    handle: Any


@dataclass(frozen=True)
class FlightScene:
    """Handles of a built scene; `show` moves them."""

    server: viser.ViserServer
    evaders: tuple[Motion, ...]
    bodies: tuple[Body, ...]
    marks: tuple[Mark, ...]
    width_km: float
    """Extent of all battlefields along x, for cameras."""
    depth_km: float
    offsets_km: tuple[NDArray[np.float64], ...] = ()
    """Where the battlefield of each flight lies, `[3]`."""

    def show(self, time_s: float) -> None:
        """Place everything as it is at this time [s]; cheap enough for twenty calls a second."""
        with self.server.atomic():
            for body in self.bodies:
                _place(body, time_s)
            for mark in self.marks:
                _set_visible(mark.handle, time_s >= mark.time_s)


def build_scene(
    server: viser.ViserServer,
    flights: Sequence[Trajectory],
    colours: Sequence[str],
    mode: Mode = "dark",
    overlay: bool = False,
    root: str = "",
) -> FlightScene:
    """Replace the server's scene by these flights, side by side, or all on one battlefield when `overlay`.

    Args:
        server: a viser server; what it showed before is removed.
        flights: one flight per battlefield, of one scenario.
        colours: `#rrggbb` of each flight's evader.
        mode: dark or light ground.
        overlay: draw all flights on one battlefield.
        root: prefix of all names. viser keeps the place of a name that comes back, so it should be a new one each time.
    """
    look, field = ground(mode), flights[0].task.scenario.battlefield
    pitch = 0.0 if overlay else field.length_m * KM + GAP_KM
    server.scene.reset()
    server.scene.set_up_direction("+z")
    server.scene.configure_default_lights(True, cast_shadow=False)
    server.scene.configure_environment_map(None)
    server.scene.set_background_image(np.full((2, 2, 3), look.background, dtype=np.uint8), format="png")
    bodies: list[Body] = []
    marks: list[Mark] = []
    offsets = tuple(np.array([(n - (len(flights) - 1) / 2) * pitch, 0.0, 0.0]) for n in range(len(flights)))
    with server.atomic():
        for number, (flight, colour, offset) in enumerate(zip(flights, colours, offsets, strict=True)):
            if number == 0 or not overlay:
                add_battlefield(server, f"{root}/field_{number}", field, look, offset)
            added = add_flight(server, f"{root}/flight_{number}", flight, colour, look, offset)
            bodies += added[0]
            marks += added[1]
    width = field.length_m * KM + pitch * (len(flights) - 1)
    evaders = tuple(body.motion for body in bodies if body.mesh.name.endswith("/evader"))
    scene = FlightScene(server, evaders, tuple(bodies), tuple(marks), width, field.width_m * KM, offsets)
    scene.show(0.0)
    return scene


def add_flight(
    server: viser.ViserServer, name: str, flight: Trajectory, colour: str, look: Ground, offset_km: NDArray
) -> tuple[list[Body], list[Mark]]:
    """Add the bodies and marks of one flight, whose battlefield lies at `offset_km`, under `name`."""
    end_s, scale = float(flight.time_s[-1]), drawing_scale(flight.task.scenario.battlefield)
    shot = flight.outcome == Outcome.SHOT_DOWN
    parts = [("evader", flight.evader, colour, aircraft(), AIRCRAFT_KM, end_s if shot else np.inf)]
    parts.append(("interceptor", flight.interceptor, INTERCEPTOR, aircraft(), AIRCRAFT_KM, np.inf))
    for track in flight.missiles:
        gone = track.end_s if np.isfinite(track.end_s) else np.inf
        parts.append((f"missile_{track.number}", track, missile_colour(track.number), missile(), MISSILE_KM, gone))
    bodies, marks = [], []
    for part, track, ink, mesh, size, gone in parts:
        path = motion(track, flight.time_s, EXAGGERATION, offset_km)
        if path.flies:
            bodies.append(
                _add_body(server, f"{name}/{part}", path, mesh, size * scale, scene_ink(ink, look), look, float(gone))
            )
    for track in flight.missiles:
        if track.fate in (Fate.EVADED, Fate.HIT):
            path = motion(track, flight.time_s, EXAGGERATION, offset_km)
            hit = track.fate == Fate.HIT
            ink = BURST if hit else scene_ink(missile_colour(track.number), look)
            size = (4.0 if hit else 1.1) * scale
            marks.append(_add_mark(server, f"{name}/end_{track.number}", path, ink, size, track.end_s))
    if shot:
        path = motion(flight.evader, flight.time_s, EXAGGERATION, offset_km)
        marks.append(_add_mark(server, f"{name}/shot_down", path, rgb(FAILURE), 2.4 * scale, end_s))
    return bodies, marks


def _add_body(
    server: viser.ViserServer,
    name: str,
    path: Motion,
    mesh: Mesh,
    size_km: float,
    ink: Rgb,
    look: Ground,
    gone_after_s: float,
) -> Body:
    whole = path.position_km[:: max(1, len(path.position_km) // PATH_POINTS)]
    nowhere = np.zeros(3)
    draw_lines(server, f"{name}_path", segments(whole), blend(ink, look.field, look.faint), 1.8, nowhere)
    tail = draw_lines(server, f"{name}_tail", _tail(path, float(path.time_s[0])), ink, 3.2, nowhere)
    drop = draw_lines(
        server, f"{name}_drop", _drop(path.position_km[0]), blend(ink, look.field, look.faint), 1.2, nowhere
    )
    shape = server.scene.add_mesh_simple(
        name,
        mesh.vertices * size_km,
        mesh.faces,
        color=ink,
        flat_shading=True,
        side="double",
        cast_shadow=False,
        receive_shadow=False,
    )
    return Body(path, shape, tail, drop, gone_after_s)


def _add_mark(server: viser.ViserServer, name: str, path: Motion, ink: Rgb, radius_km: float, time_s: float) -> Mark:
    ball = server.scene.add_icosphere(
        name,
        radius=radius_km,
        color=ink,
        opacity=0.75,
        subdivisions=2,
        position=tuple(path.position_km[-1]),
        visible=False,
        cast_shadow=False,
        receive_shadow=False,
    )
    return Mark(float(time_s), ball)


def _place(body: Body, time_s: float) -> None:
    flying = float(body.motion.time_s[0]) <= time_s <= body.gone_after_s
    for handle in (body.mesh, body.tail, body.drop):
        _set_visible(handle, flying)
    if flying:
        position = body.motion.position(time_s)
        body.mesh.position, body.mesh.wxyz = position, body.motion.attitude(time_s)
        body.tail.points = _tail(body.motion, time_s)
        body.drop.points = _drop(position)


def _set_visible(handle: Any, visible: bool) -> None:
    if handle.visible != visible:
        handle.visible = visible


def _tail(path: Motion, time_s: float) -> NDArray[np.float64]:
    # Just above the whole path, or the two would flicker through each other.
    return path.tail(time_s, TAIL_S, TAIL_POINTS) + np.array([0.0, 0.0, TAIL_LIFT_KM])


def _drop(position_km: NDArray) -> NDArray[np.float64]:
    return segments(np.array([position_km, position_km * (1.0, 1.0, 0.0)]))
