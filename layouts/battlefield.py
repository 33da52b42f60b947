"""The battlefield of a 3-D scene (Fig. 2): ground, grid, border and exit gate; kilometres, +z up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.motion import KM, segments
from layouts.theme import GATE, Ground, Rgb, scene_ink
from sim.scenario import Battlefield

EXAGGERATION = 4.0
"""Altitudes are drawn this many times higher than they are, or a flight over 200 km would look flat."""

GRID_KM = 20.0
GATE_KM = 9.0
GATE_RUNGS = 7
USUAL_KM = (220.0, 76.0)
"""The battlefield for which bodies and gate have their sizes."""


def drawing_scale(field: Battlefield) -> float:
    """Factor on the size of bodies and gate: as large in the picture of any battlefield; 1 for the usual one."""
    return math.hypot(field.length_m, field.width_m) * KM / math.hypot(*USUAL_KM)


def add_battlefield(server: viser.ViserServer, name: str, field: Battlefield, look: Ground, offset_km: NDArray) -> None:
    """Ground, grid, border and exit gate of one battlefield (Fig. 2)."""
    half = np.array([field.length_m, field.width_m]) * KM / 2
    corners = np.array([(-half[0], -half[1], 0), (half[0], -half[1], 0), (half[0], half[1], 0), (-half[0], half[1], 0)])
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    scene, place = server.scene, {"position": tuple(offset_km)}
    scene.add_mesh_simple(
        f"{name}/ground",
        corners - (0, 0, 0.15),
        faces,
        color=look.field,
        side="double",
        flat_shading=True,
        cast_shadow=False,
        receive_shadow=False,
        **place,
    )
    lines = [((x, -half[1], 0), (x, half[1], 0)) for x in _ticks(half[0])]
    lines += [((-half[0], y, 0), (half[0], y, 0)) for y in _ticks(half[1])]
    draw_lines(server, f"{name}/grid", np.array(lines), look.grid, 1.0, offset_km)
    draw_lines(server, f"{name}/border", segments(corners[[0, 1, 2, 3, 0]]), look.border, 2.0, offset_km)
    low, high = ((field.exit_y_m + side * field.exit_half_width_m) * KM for side in (-1, 1))
    top = GATE_KM * EXAGGERATION * drawing_scale(field)
    rungs = [((half[0], low, z), (half[0], high, z)) for z in np.linspace(0.0, top, GATE_RUNGS)]
    posts = [((half[0], y, 0.0), (half[0], y, top)) for y in (low, high)]
    draw_lines(server, f"{name}/gate", np.array(rungs + posts), scene_ink(GATE, look), 2.5, offset_km)


def draw_lines(
    server: viser.ViserServer, name: str, points: NDArray, ink: Rgb, pixels: float, offset_km: NDArray
) -> Any:
    """Line segments [N, 2, 3] of a fixed width on the screen; returns viser's handle."""
    return server.scene.add_line_segments(
        name, points, ink, thickness=pixels, thickness_units="screen", position=tuple(offset_km)
    )


def _ticks(half_km: float) -> NDArray[np.float64]:
    return np.arange(np.ceil(-half_km / GRID_KM), np.floor(half_km / GRID_KM) + 1) * GRID_KM
