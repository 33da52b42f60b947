"""The 3-D replay in a viser scene (Fig. 10, 11): battlefields, bodies, trails, gates; kilometres, +z up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.battlefield import EXAGGERATION, add_battlefield, drawing_scale
from layouts.captions import distance_text
from layouts.energy import energy_share
from layouts.meshes import aircraft, missile
from layouts.motion import KM, Motion, motion
from layouts.scene_bodies import BEAM_KM, TAIL_POINTS, TAIL_S, Additions, Body, Mark, add_body, add_label_mark
from layouts.theme import FAILURE, INTERCEPTOR, Ground, Mode, Rgb, ground, missile_colour, rgb, scene_ink
from sim.trajectory import MissileTrack, Trajectory
from sim.world import Fate, Outcome

__all__ = ["AIRCRAFT_KM", "MISSILE_KM", "TAIL_POINTS", "TAIL_S", "Additions", "Body", "FlightScene", "Mark"]

ALL = Additions()
GAP_KM = 14.0
LETTERS = "ABCDEFGH"
"""Flights by their letters, as everywhere on the page."""
AIRCRAFT_KM = 7.5
MISSILE_KM = 4.8
BURST = (255, 150, 60)
MISS_SHOWN_S = 20.0
"""How long a miss distance stays in the picture."""


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

    def show(self, time_s: float, additions: Additions = ALL) -> None:
        """Place everything as it is at this time [s]; cheap enough for fifty calls a second."""
        with self.server.atomic():
            for thing in (*self.bodies, *self.marks):
                thing.place(time_s, additions)

    def paint(self, additions: Additions) -> None:
        """After the additions have changed: bring along what `show` does not touch."""
        with self.server.atomic():
            for body in self.bodies:
                body.paint(additions)


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
    # The background is the page's: without a graphics card, painting it in the scene costs a third of a frame.
    look, field = ground(mode), flights[0].task.scenario.battlefield
    pitch = 0.0 if overlay else field.length_m * KM + GAP_KM
    server.scene.reset()
    server.scene.set_up_direction("+z")
    server.scene.configure_default_lights(True, cast_shadow=False)
    server.scene.configure_environment_map(None)
    bodies: list[Body] = []
    marks: list[Mark] = []
    offsets = tuple(np.array([(n - (len(flights) - 1) / 2) * pitch, 0.0, 0.0]) for n in range(len(flights)))
    with server.atomic():
        for number, (flight, colour, offset) in enumerate(zip(flights, colours, offsets, strict=True)):
            if number == 0 or not overlay:
                add_battlefield(server, f"{root}/field_{number}", field, look, offset)
            added = add_flight(server, f"{root}/flight_{number}", flight, colour, look, offset, LETTERS[number])
            bodies += added[0]
            marks += added[1]
    width = field.length_m * KM + pitch * (len(flights) - 1)
    evaders = tuple(body.motion for body in bodies if body.mesh.name.endswith("/evader"))
    scene = FlightScene(server, evaders, tuple(bodies), tuple(marks), width, field.width_m * KM, offsets)
    scene.show(0.0)
    return scene


def add_flight(
    server: viser.ViserServer, name: str, flight: Trajectory, colour: str, look: Ground, offset_km: NDArray,
    letter: str = "",
) -> tuple[list[Body], list[Mark]]:  # fmt: skip
    """Add the bodies and marks of one flight, whose battlefield lies at `offset_km`, under `name`.

    Its evader is called `letter` in the picture; without one, no body has a name.
    """
    end_s, scale = float(flight.time_s[-1]), drawing_scale(flight.task.scenario.battlefield)
    evader = motion(flight.evader, flight.time_s, EXAGGERATION, offset_km)
    interceptor = motion(flight.interceptor, flight.time_s, EXAGGERATION, offset_km)
    shot = flight.outcome == Outcome.SHOT_DOWN
    craft, size = aircraft(), AIRCRAFT_KM * scale
    parts = [("evader", evader, colour, end_s if shot else np.inf, letter, BEAM_KM * scale)]
    parts.append(("interceptor", interceptor, INTERCEPTOR, np.inf, "interceptor" if letter else "", 0.0))
    bodies = [
        add_body(
            server,
            f"{name}/{part}",
            path,
            craft,
            size,
            scene_ink(ink, look),
            look,
            gone,
            text=text,
            beams_km=beams_km,
            text_at="bottom-right" if part == "evader" else "bottom-left",
        )
        for part, path, ink, gone, text, beams_km in parts
        if path.flies
    ]
    marks = []
    for track in flight.missiles:
        path = motion(track, flight.time_s, EXAGGERATION, offset_km)
        if path.flies:
            bodies.append(_add_missile(server, name, track, path, evader, flight, look, letter))
            marks += _add_ends(server, name, track, path, evader, flight, look, bool(letter))
    if shot and evader.flies:
        marks.append(_add_ball(server, f"{name}/shot_down", evader, rgb(FAILURE), 2.4 * scale, end_s))
    return bodies, marks


def _add_missile(
    server: viser.ViserServer, name: str, track: MissileTrack, path: Motion, evader: Motion, flight: Trajectory,
    look: Ground, letter: str,
) -> Body:  # fmt: skip
    scale = drawing_scale(flight.task.scenario.battlefield)
    share, known = energy_share(track), np.isfinite(track.position_m[:, 0])
    return add_body(
        server, f"{name}/missile_{track.number}", path, missile(), MISSILE_KM * scale,
        scene_ink(missile_colour(track.number), look), look, track.end_s if np.isfinite(track.end_s) else np.inf,
        text=str(track.number) if letter else "", seen_from=evader,
        energy=np.interp(path.time_s, flight.time_s[known], share[known]),
    )  # fmt: skip


def _add_ends(
    server: viser.ViserServer, name: str, track: MissileTrack, path: Motion, evader: Motion, flight: Trajectory,
    look: Ground, named: bool,
) -> list[Mark]:  # fmt: skip
    """How a missile ended: a burst or a small ball, and how far away it passed the evader."""
    if track.fate not in (Fate.EVADED, Fate.HIT):
        return []
    scale, hit = drawing_scale(flight.task.scenario.battlefield), track.fate == Fate.HIT
    ink = BURST if hit else scene_ink(missile_colour(track.number), look)
    marks = [_add_ball(server, f"{name}/end_{track.number}", path, ink, (4.0 if hit else 1.1) * scale, track.end_s)]
    if named and np.isfinite(track.closest_m) and evader.flies:
        closest_s = float(flight.time_s[np.nanargmin(track.range_m)])
        words = f"{track.number} {'hit' if hit else 'missed by'} {distance_text(track.closest_m)}"
        place = evader.position(closest_s)
        marks.append(add_label_mark(server, f"{name}/miss_{track.number}", words, place, closest_s, MISS_SHOWN_S))
    return marks


def _add_ball(server: viser.ViserServer, name: str, path: Motion, ink: Rgb, radius_km: float, time_s: float) -> Mark:
    ball = server.scene.add_icosphere(
        name, radius=radius_km, color=ink, opacity=0.75, subdivisions=2, position=tuple(path.position_km[-1]),
        visible=False, cast_shadow=False, receive_shadow=False,
    )  # fmt: skip
    return Mark(float(time_s), ball)
