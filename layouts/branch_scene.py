"""A branch in the 3-D replay: what it flies differently, on the battlefield of the flight that it leaves."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
import viser
from numpy.typing import NDArray

from layouts.scene import FlightScene, add_flight
from layouts.theme import Mode, ground
from sim.trajectory import BodyTrack, MissileTrack, Trajectory

Track = TypeVar("Track", BodyTrack, MissileTrack)


def add_branch(
    server: viser.ViserServer, scene: FlightScene, on: int, branch: Trajectory, from_s: float, colour: str,
    mode: Mode, root: str, letter: str = "",
) -> FlightScene:  # fmt: skip
    """Draw a branch from the moment `from_s` [s] on over flight `on` of a scene; what it returns moves it.

    Args:
        server: the server of the scene.
        scene: the flights, as `build_scene` made them.
        on: number of the flight that the branch leaves.
        branch: the whole branch.
        from_s: when it leaves that flight [s]; before, it is not drawn: there it is that flight.
        colour: `#rrggbb` of its evader.
        mode: dark or light ground.
        root: name above all of its names, unused so far.
        letter: how its evader is called in the picture.
    """
    with server.atomic():
        server.scene.add_frame(root, show_axes=False)
        shown, place = later(branch, from_s), scene.offsets_km[on]
        bodies, marks = add_flight(server, root, shown, colour, ground(mode), place, letter)
    evaders = tuple(body.motion for body in bodies if body.mesh.name.endswith("/evader"))
    own = [mark for mark in marks if mark.time_s > from_s]
    return replace(scene, evaders=evaders, bodies=tuple(bodies), marks=tuple(own))


def later(flight: Trajectory, from_s: float) -> Trajectory:
    """The flight with every body in flight only from a moment [s] on, without missiles that no longer fly."""
    kept = flight.time_s >= from_s - 1e-6
    flown = [track for track in flight.missiles if np.isfinite(track.position_m[kept, 0]).any()]
    return replace(
        flight,
        evader=_kept(flight.evader, kept),
        interceptor=_kept(flight.interceptor, kept),
        missiles=tuple(_kept(track, kept) for track in flown),
    )


def _kept(track: Track, kept: NDArray[np.bool_]) -> Track:
    return replace(track, position_m=np.where(kept[:, None], track.position_m, np.nan))
