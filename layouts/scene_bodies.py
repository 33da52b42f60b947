"""What moves in the 3-D replay: bodies with trail, name, beam lines, line of sight and energy; kilometres, +z up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.battlefield import draw_lines
from layouts.energy import energy_colours
from layouts.meshes import Mesh
from layouts.motion import Motion, quaternions, segments
from layouts.theme import Ground, Rgb, blend

TAIL_S = 75.0
TAIL_POINTS = 26
TAIL_LIFT_KM = 0.4
PATH_TURN_RAD = math.radians(4.0)
PATH_GAP_S = 10.0
"""A whole path bends at every so much of a turn, and at least this often: it takes colour from the energy there."""
BEAM_KM = 24.0
BEAM_DASHES = 9
LABEL_SCALE = 0.8
NOWHERE = np.zeros(3)
Corner = Literal["bottom-left", "bottom-right", "top-right"]
"""Which corner of a name stands at its place: an evader's, a missile's and a miss distance meet there, and differ."""


@dataclass(frozen=True)
class Additions:
    """Which additions to the bodies are drawn."""

    labels: bool = True
    """Names of bodies, and miss distances for a while after a missile has passed."""
    trails: bool = True
    """The whole path, faint, and the last 75 s of it."""
    sight: bool = True
    """A line from the evader to every missile in flight."""
    beams: bool = True
    """Lines at ±90° off the evader's nose: where defensive dragging holds the closest missile."""
    energy: bool = False
    """Trails of missiles in the colour of the energy they had there."""


@dataclass(frozen=True)
class EnergyInk:
    """The colours of a missile's trail: its own, and those of its energy share along its motion."""

    own: Rgb
    faint: Rgb
    look: Ground
    share: NDArray[np.float64]
    """`[N]` at the samples of the motion."""

    def at(self, motion: Motion, times_s: NDArray[np.floating]) -> NDArray[np.uint8]:
        """Colours `[n, 3]` at these times."""
        return energy_colours(np.interp(times_s, motion.time_s, self.share), self.look)


@dataclass(frozen=True)
class Body:
    """One moving body: its motion and the handles that show it; None where it has no such thing."""

    motion: Motion
    mesh: Any
    tail: Any
    drop: Any
    gone_after_s: float
    path: Any = None
    label: Any = None
    beams: Any = None
    sight: Any = None
    seen_from: Motion | None = None
    """Whose line of sight to this body is drawn."""
    energy: EnergyInk | None = None

    def place(self, time_s: float, additions: Additions) -> None:
        """Show the body as it is at this time [s]."""
        flying = float(self.motion.time_s[0]) <= time_s <= self.gone_after_s
        set_visible(self.mesh, flying)
        set_visible(self.drop, flying)
        set_visible(self.tail, flying and additions.trails)
        for handle, wanted in ((self.beams, additions.beams), (self.sight, additions.sight)):
            if handle is not None:
                set_visible(handle, flying and wanted)
        if flying:
            self._move(time_s, additions)

    def paint(self, additions: Additions) -> None:
        """Bring what does not depend on the time in line with the additions: whole path, name, colours of trails."""
        if self.path is not None:
            set_visible(self.path, additions.trails)
        if self.label is not None:
            set_visible(self.label, additions.labels)
        if self.energy is not None and self.path is not None:
            faint = np.broadcast_to(np.array(self.energy.faint, np.uint8), (len(self.path.points) + 1, 3))
            inks = self.energy.at(self.motion, _path_times(self.motion)) if additions.energy else faint
            self.path.colors = _segment_colours(inks)
            if not additions.energy:
                self.tail.colors = np.broadcast_to(np.array(self.energy.own, np.uint8), self.tail.points.shape).copy()

    def _move(self, time_s: float, additions: Additions) -> None:
        position = self.motion.position(time_s)
        self.mesh.position, self.mesh.wxyz = position, self.motion.attitude(time_s)
        self.drop.points = drop_line(position)
        if additions.trails:
            self.tail.points = tail_lines(self.motion, time_s)
            if additions.energy and self.energy is not None:
                times = self.motion.tail_times(time_s, TAIL_S, TAIL_POINTS)
                self.tail.colors = _segment_colours(self.energy.at(self.motion, times))
        if additions.beams and self.beams is not None:
            level = quaternions(np.array([self.motion.heading(time_s)]), NOWHERE[:1], NOWHERE[:1])[0]
            self.beams.position, self.beams.wxyz = position, level
        if additions.sight and self.sight is not None and self.seen_from is not None:
            self.sight.points = segments(np.array([self.seen_from.position(time_s), position]))


@dataclass(frozen=True)
class Mark:
    """Something that appears at a time: a missile's end, a shot-down evader, for a while a miss distance."""

    time_s: float
    handle: Any
    until_s: float = np.inf
    is_label: bool = False

    def place(self, time_s: float, additions: Additions) -> None:
        """Show or hide it."""
        wanted = additions.labels or not self.is_label
        set_visible(self.handle, wanted and self.time_s <= time_s <= self.until_s)


def add_body(
    server: viser.ViserServer, name: str, path: Motion, mesh: Mesh, size_km: float, ink: Rgb, look: Ground,
    gone_after_s: float, text: str = "", energy: NDArray[np.float64] | None = None,
    seen_from: Motion | None = None, beams_km: float = 0.0, text_at: Corner = "bottom-left",
) -> Body:  # fmt: skip
    """Add a body with its path, trail and drop line; name, line of sight and beam lines where they are asked for.

    Args:
        server: the viser server.
        name: name of its mesh.
        path: how it moves.
        mesh: its shape, one unit long.
        size_km: its length.
        ink: its colour.
        look: the ground it is drawn on.
        gone_after_s: when it disappears [s].
        text: its name in the picture; none when empty.
        energy: energy share `[N]` at the samples of its motion.
        seen_from: the evader, for a line of sight.
        beams_km: length of the beam lines; none when 0.
        text_at: the corner of its name that stands at the body.
    """
    faint = blend(ink, look.field, look.faint)
    whole = path.position(_path_times(path))
    way = draw_lines(server, f"{name}_path", segments(whole), faint, 1.8, NOWHERE)
    tail = draw_lines(server, f"{name}_tail", tail_lines(path, float(path.time_s[0])), ink, 3.2, NOWHERE)
    drop = draw_lines(server, f"{name}_drop", drop_line(path.position_km[0]), faint, 1.2, NOWHERE)
    shape = server.scene.add_mesh_simple(
        name, mesh.vertices * size_km, mesh.faces, color=ink, flat_shading=True, side="double", cast_shadow=False,
        receive_shadow=False,
    )  # fmt: skip
    return Body(
        path, shape, tail, drop, gone_after_s, way,
        label=_add_label(server, f"{name}/name", text, np.zeros(3), text_at) if text else None,
        beams=_add_beams(server, f"{name}_beams", beams_km, ink, look) if beams_km else None,
        sight=_add_sight(server, f"{name}_sight", path, seen_from, ink, look) if seen_from else None,
        seen_from=seen_from,
        energy=None if energy is None else EnergyInk(ink, faint, look, energy),
    )  # fmt: skip


def add_label_mark(
    server: viser.ViserServer, name: str, text: str, position_km: NDArray, time_s: float, lasting_s: float
) -> Mark:
    """Words that appear at a time [s], stay for a while and go."""
    label = _add_label(server, name, text, position_km, "top-right", visible=False)
    return Mark(time_s, label, time_s + lasting_s, is_label=True)


def set_visible(handle: Any, visible: bool) -> None:
    """Show or hide, and say nothing to the browser when nothing changes."""
    if handle.visible != visible:
        handle.visible = visible


def tail_lines(path: Motion, time_s: float) -> NDArray[np.float64]:
    """The last 75 s, `[n, 2, 3]`, just above the whole path, or the two would flicker through each other."""
    return path.tail(time_s, TAIL_S, TAIL_POINTS) + np.array([0.0, 0.0, TAIL_LIFT_KM])


def drop_line(position_km: NDArray) -> NDArray[np.float64]:
    """From a body straight down to the ground, `[1, 2, 3]`."""
    return segments(np.array([position_km, position_km * (1.0, 1.0, 0.0)]))


def beam_lines(length_km: float) -> NDArray[np.float64]:
    """Dashes `[n, 2, 3]` to the left and to the right of a nose along +x."""
    ends = np.linspace(0.0, length_km, 2 * BEAM_DASHES)
    dashes = np.zeros((BEAM_DASHES, 2, 3))
    dashes[:, :, 1] = ends.reshape(-1, 2)
    return np.concatenate([dashes, dashes * (1.0, -1.0, 1.0)])


def _path_times(path: Motion) -> NDArray[np.float64]:
    """When a path has turned or flown one step further, and its ends: few samples where it is straight.

    Without a graphics card the picture costs as much as it has segments.
    """
    along = np.diff(path.position_km, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    bends = np.linalg.norm(np.diff(along, axis=0), axis=1)  # the angle, for as small ones as these
    turned = np.concatenate([[0.0], np.cumsum(bends), [0.0]])[: len(path.time_s)]
    steps = np.floor(turned / PATH_TURN_RAD) + np.floor((path.time_s - path.time_s[0]) / PATH_GAP_S)
    kept = np.flatnonzero(np.diff(steps, prepend=-1.0, append=-1.0)[:-1])
    return path.time_s[np.union1d(kept, [0, len(steps) - 1])]


def _segment_colours(points: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.stack([points[:-1], points[1:]], axis=1)


def _add_label(
    server: viser.ViserServer, name: str, text: str, position_km: NDArray, corner: Corner, visible: bool = True
) -> Any:
    return server.scene.add_label(
        name, text, position=tuple(position_km), anchor=corner, font_screen_scale=LABEL_SCALE, visible=visible
    )


def _add_beams(server: viser.ViserServer, name: str, length_km: float, ink: Rgb, look: Ground) -> Any:
    return draw_lines(server, name, beam_lines(length_km), blend(ink, look.field, 0.25), 1.6, NOWHERE)


def _add_sight(server: viser.ViserServer, name: str, path: Motion, seen_from: Motion, ink: Rgb, look: Ground) -> Any:
    begin = float(path.time_s[0])
    line = segments(np.array([seen_from.position(begin), path.position_km[0]]))
    return draw_lines(server, name, line, blend(ink, look.field, 0.3), 1.4, NOWHERE)
