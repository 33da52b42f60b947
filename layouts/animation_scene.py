"""One flight in 3-D in an animation: battlefield, gate, paths, trails, bodies, ends of missiles, at any time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from layouts.animation_camera import Camera, Points
from layouts.battlefield import EXAGGERATION, GATE_KM, GATE_RUNGS, GRID_KM, drawing_scale
from layouts.meshes import Mesh, aircraft, missile
from layouts.motion import KM, Motion, motion
from layouts.scene import AIRCRAFT_KM, BURST, MISSILE_KM, TAIL_S
from layouts.theme import DARK, GATE, INTERCEPTOR, Rgb, blend, missile_colour, rgb, scene_ink
from sim.scenario import Battlefield
from sim.trajectory import Trajectory
from sim.world import Fate, Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LIGHT = np.array([-0.35, -0.5, 0.8]) / math.hypot(0.35, 0.5, 0.8)
TAIL_PIECES, TAIL_STEP = 10, 5
PATH_POINTS = 260
LINE_POINTS = 45
"""Points of a grid line: what is behind the eye is left out point by point."""

BURST_S = 14.0
Lines = list[tuple[Points, tuple[float, ...], float]]
"""Polylines [N, 2], their colours with opacity, their widths [pixels]."""


@dataclass(frozen=True)
class Flyer:
    """A body, when it can be seen, and how it is drawn."""

    name: str
    path: Motion
    mesh: Mesh
    ink: Rgb
    size_km: float
    pixels: tuple[float, float]
    """Smallest and largest size on the screen."""
    gone_s: float

    def flies(self, time_s: float) -> bool:
        """Whether it is there."""
        return self.path.flies and float(self.path.time_s[0]) <= time_s <= self.gone_s


def flyers(flight: Trajectory, colour: str) -> list[Flyer]:
    """Evader, interceptor and the missiles that were launched."""
    scale, nowhere = drawing_scale(flight.task.scenario.battlefield), np.zeros(3)
    shot = flight.outcome is Outcome.SHOT_DOWN
    bodies = [
        ("evader", flight.evader, aircraft(), colour, AIRCRAFT_KM, (26.0, 58.0), flight.duration_s if shot else np.inf),
        ("interceptor", flight.interceptor, aircraft(), INTERCEPTOR, AIRCRAFT_KM, (26.0, 58.0), np.inf),
    ]
    for track in flight.missiles:
        end_s = track.end_s if np.isfinite(track.end_s) else np.inf
        ink = missile_colour(track.number)
        bodies.append((str(track.number), track, missile(), ink, MISSILE_KM, (16.0, 34.0), end_s))
    made = [
        Flyer(name, motion(track, flight.time_s, EXAGGERATION, nowhere), mesh, scene_ink(ink, DARK), km * scale, pixels,
              float(gone))
        for name, track, mesh, ink, km, pixels, gone in bodies
    ]  # fmt: skip
    return [flyer for flyer in made if flyer.path.flies]


def field_lines(view: Camera, field: Battlefield) -> Lines:
    """Grid, border and exit gate."""
    x, y = field.length_m * KM / 2, field.width_m * KM / 2
    ticks = [np.arange(math.ceil(-half / GRID_KM), math.floor(half / GRID_KM) + 1) * GRID_KM for half in (x, y)]
    grid = [((tick, -y, 0.0), (tick, y, 0.0)) for tick in ticks[0]]
    grid += [((-x, tick, 0.0), (x, tick, 0.0)) for tick in ticks[1]]
    corners = [(-x, -y, 0.0), (x, -y, 0.0), (x, y, 0.0), (-x, y, 0.0), (-x, -y, 0.0)]
    low, high = ((field.exit_y_m + side * field.exit_half_width_m) * KM for side in (-1, 1))
    top, green = GATE_KM * EXAGGERATION * drawing_scale(field), scene_ink(GATE, DARK)
    rungs = [((x, low, z), (x, high, z)) for z in np.linspace(0.0, top, GATE_RUNGS)]
    posts = [((x, side, 0.0), (x, side, top)) for side in (low, high)]
    lines = [_ruler(view, ends, DARK.grid, 1.0) for ends in grid]
    lines += [_ruler(view, ends, DARK.border, 1.7) for ends in pairwise(corners)]
    return (
        lines + [_ruler(view, ends, green, 1.5) for ends in rungs] + [_ruler(view, ends, green, 2.4) for ends in posts]
    )


def field_corners(field: Battlefield, height_km: float = 0.0) -> Points:
    """Corners [4, 3] of the battlefield at a height."""
    x, y = field.length_m * KM / 2, field.width_m * KM / 2
    return np.array([(-x, -y, height_km), (x, -y, height_km), (x, y, height_km), (-x, y, height_km)])


def path_lines(view: Camera, flyer: Flyer, time_s: float) -> Lines:
    """What is still to be flown, faint; what has been flown; the last minute, bright; the line to the ground."""
    path = flyer.path
    first, last = float(path.time_s[0]), float(path.time_s[-1])
    thin = slice(None, None, max(1, len(path.time_s) // PATH_POINTS))
    whole = view.screen(path.position_km[thin])
    lines: Lines = [(whole, _rgba(flyer.ink, 0.16), 1.1)]
    if time_s <= first:
        return lines
    now = min(time_s, last)
    place = path.position(now)
    so_far = whole[: int(np.searchsorted(path.time_s[thin], now))]
    lines.append((np.vstack([so_far, view.screen(place)]), _rgba(flyer.ink, 0.5), 1.5))
    if not flyer.flies(time_s):
        return lines
    tail = view.screen(path.position(np.linspace(max(first, now - TAIL_S), now, TAIL_PIECES * TAIL_STEP + 1)))
    for piece in range(TAIL_PIECES):
        share = (piece + 1) / TAIL_PIECES
        part = tail[piece * TAIL_STEP : (piece + 1) * TAIL_STEP + 1]
        lines.append((part, _rgba(flyer.ink, 0.2 + 0.8 * share), 1.2 + 2.2 * share))
    drop = np.stack([place, place * (1.0, 1.0, 0.0)])
    return [*lines, (view.screen(drop), _rgba(flyer.ink, 0.4), 1.0)]


def solids(view: Camera, bodies: list[Flyer], time_s: float) -> tuple[list[Points], NDArray[np.float64]]:
    """Triangles [3, 2] of all bodies from far to near, and their colours [N, 3]."""
    triangles, colours, depths = [], [], []
    for flyer in bodies:
        if not flyer.flies(time_s):
            continue
        place = flyer.path.position(time_s)
        pixel_km = max(float(view.see(place)[2]), 1.0) / view.focal
        size = float(np.clip(flyer.size_km, flyer.pixels[0] * pixel_km, flyer.pixels[1] * pixel_km))
        corners = place + (flyer.mesh.vertices * size) @ _rotation(flyer.path.attitude(time_s)).T
        faces = corners[flyer.mesh.faces.astype(np.intp)]
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        lit = 0.45 + 0.55 * np.abs(normals @ LIGHT)
        seen = view.see(faces)
        triangles.append(view.place(seen))
        depths.append(seen[..., 2].mean(axis=1))
        colours.append(np.array(flyer.ink) / 255 * lit[:, None])
    if not triangles:
        return [], np.zeros((0, 3))
    order = np.argsort(-np.concatenate(depths))
    return list(np.concatenate(triangles)[order]), np.concatenate(colours)[order]


def sight_lines(view: Camera, bodies: list[Flyer], time_s: float) -> Lines:
    """Lines of sight from the evader to every missile in flight."""
    evader = bodies[0]
    flown = [body for body in bodies[2:] if body.flies(time_s)]
    if not evader.flies(time_s):
        return []
    ends = [np.stack([evader.path.position(time_s), body.path.position(time_s)]) for body in flown]
    return [(view.screen(each), _rgba(body.ink, 0.45), 1.0) for each, body in zip(ends, flown, strict=True)]


def draw_ends(axes: Axes, view: Camera, flight: Trajectory, bodies: list[Flyer], time_s: float) -> list[Any]:
    """Rings where missiles were evaded, a fire where one hit."""
    drawn: list[Any] = []
    paths = {body.name: body for body in bodies}
    for track in flight.missiles:
        if track.fate not in (Fate.EVADED, Fate.HIT) or not time_s >= track.end_s:
            continue
        body, young = paths[str(track.number)], float(np.clip(1.0 - (time_s - track.end_s) / BURST_S, 0.0, 1.0))
        x, y = view.screen(body.path.position_km[-1])
        if track.fate is Fate.EVADED:
            ring = {"markersize": 5.5 + 9.0 * young, "markerfacecolor": "none", "markeredgewidth": 1.2, "alpha": 0.85}
            drawn += axes.plot(x, y, "o", color=_rgba(body.ink, 1.0), **ring)
            continue
        for size, strength in ((34.0, 0.16), (22.0, 0.3), (12.0, 0.75), (5.0, 1.0)):
            ink = blend(BURST, (255, 240, 200), 1.0 if size < 6 else 0.0)
            drawn += axes.plot(
                x,
                y,
                "o",
                color=_rgba(ink, 1.0),
                markersize=size * (0.6 + 0.6 * young),
                alpha=strength,
                markeredgewidth=0,
            )
    return drawn


def _ruler(view: Camera, ends: tuple[Any, Any], ink: Rgb, width: float) -> tuple[Points, tuple[float, ...], float]:
    return view.screen(np.linspace(ends[0], ends[1], LINE_POINTS)), _rgba(ink, 1.0), width


def _rgba(ink: Rgb | str, strength: float) -> tuple[float, ...]:
    colour = rgb(ink) if isinstance(ink, str) else ink
    return (*(value / 255 for value in colour), strength)


def _rotation(wxyz: NDArray[np.float64]) -> Points:
    w, x, y, z = wxyz
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
