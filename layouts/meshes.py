"""Low-poly bodies built by code: an aircraft and a missile, nose along +x, up +z, one unit long."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Mesh(NamedTuple):
    """Triangles: `vertices` [V, 3] and `faces` [F, 3] of vertex numbers, counter-clockwise from outside."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


def aircraft() -> Mesh:
    """A delta-winged jet with a fin."""
    fuselage = spindle([(0.5, 0.0), (0.22, 0.055), (-0.2, 0.075), (-0.46, 0.05), (-0.46, 0.0)])
    wing = plate([(0.18, 0.0), (-0.3, 0.46), (-0.4, 0.46), (-0.34, 0.0), (-0.4, -0.46), (-0.3, -0.46)], 0.022)
    tail = plate([(-0.3, 0.0), (-0.46, 0.2), (-0.52, 0.2), (-0.48, 0.0), (-0.52, -0.2), (-0.46, -0.2)], 0.018)
    fin = stand_up(plate([(-0.16, 0.0), (-0.44, 0.26), (-0.54, 0.26), (-0.46, 0.0)], 0.018))
    return join(fuselage, wing, tail, fin)


def missile() -> Mesh:
    """A slender body with four tail fins."""
    body = spindle([(0.5, 0.0), (0.3, 0.1), (-0.5, 0.1), (-0.5, 0.0)])
    fins = plate([(-0.1, 0.0), (-0.4, 0.3), (-0.52, 0.3), (-0.52, -0.3), (-0.4, -0.3)], 0.02)
    return join(body, fins, stand_up(fins))


def spindle(profile: list[tuple[float, float]], sides: int = 10) -> Mesh:
    """A body of revolution about x from (x, radius) pairs, nose first; a radius of 0 closes an end."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    rings = [np.stack([np.full(sides, x), r * np.cos(angle), r * np.sin(angle)], 1) for x, r in profile]
    here = np.arange(sides)
    beside = (here + 1) % sides
    faces = []
    for ring in range(len(profile) - 1):
        a, b = ring * sides, (ring + 1) * sides
        faces += [
            np.stack([a + here, b + here, a + beside], 1),
            np.stack([a + beside, b + here, b + beside], 1),
        ]
    return Mesh(np.concatenate(rings).astype(np.float32), np.concatenate(faces).astype(np.uint32))


def plate(outline: list[tuple[float, float]], thickness: float) -> Mesh:
    """A flat plate in the xy plane whose outline is star-shaped seen from its first point."""
    flat = np.array([(x, y, 0.0) for x, y in outline])
    lift = np.array([0.0, 0.0, thickness / 2])
    count = len(flat)
    fan = np.array([(0, i, i + 1) for i in range(1, count - 1)])
    edge = np.array([(i, (i + 1) % count, i + count) for i in range(count)])
    other = np.array([((i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)])
    vertices = np.concatenate([flat + lift, flat - lift]).astype(np.float32)
    return Mesh(vertices, np.concatenate([fan, fan[:, ::-1] + count, edge, other]).astype(np.uint32))


def stand_up(mesh: Mesh) -> Mesh:
    """The mesh turned by a quarter about x, so that +y points up."""
    x, y, z = mesh.vertices.T
    return Mesh(np.stack([x, -z, y], 1), mesh.faces)


def join(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = [m.faces + start for m, start in zip(meshes, starts, strict=True)]
    return Mesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces).astype(np.uint32))
