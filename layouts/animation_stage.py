"""Where each flight of an animation is drawn: its panel, its curves, its bodies, and the camera of every picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from layouts.animation_camera import Camera, Panel, Points, camera, camera_flight, fit
from layouts.animation_curves import AzimuthPlot
from layouts.animation_scene import Flyer, field_corners, flyers
from layouts.animation_time import engaged
from layouts.battlefield import EXAGGERATION
from layouts.flight_figure import engagement_s
from layouts.letters import evader_inks, letters
from layouts.motion import KM
from sim.trajectory import Trajectory

WIDTH, HEIGHT = 1280, 720
HEADER, CURVES = 66, 196
"""Heights of the strip above the 3-D view and of the one below."""

YAW_RAD, TILT_RAD = (0.0, -0.62), (0.66, 0.72)
"""Direction of the camera: for one wide view, and for two that stand beside each other."""


@dataclass(frozen=True)
class Stage:
    """One flight of the animation with where it is drawn."""

    flight: Trajectory
    letter: str
    colour: str
    panel: Panel
    plot: AzimuthPlot
    bodies: list[Flyer] = field(repr=False)
    cameras: list[Camera] = field(repr=False)


def stages_of(flights: Sequence[Trajectory], times: NDArray[np.float64], per_s: int) -> list[Stage]:
    """The stages of one flight, or of several side by side, for pictures at these times [s], `per_s` a second."""
    count = len(flights)
    windows = [engagement_s(flight) for flight in flights]
    window = min(low for low, _ in windows), max(high for _, high in windows)
    width = WIDTH / count
    made = []
    named = zip(flights, letters(flights), evader_inks(flights), strict=True)
    for number, (flight, letter, colour) in enumerate(named):
        left = number * width
        panel = Panel(left, CURVES, width, HEIGHT - HEADER - CURVES)
        plot = AzimuthPlot(flight, Panel(left + 56, 38, width - 80, CURVES - 72), window)
        bodies = flyers(flight, colour)
        made.append(Stage(flight, letter, colour, panel, plot, bodies, _cameras(flight, bodies, panel, times, per_s)))
    return made


def _cameras(
    flight: Trajectory, bodies: list[Flyer], panel: Panel, times: NDArray[np.float64], per_s: int
) -> list[Camera]:
    place = flight.task.scenario.battlefield
    ceiling_km = float(flight.evader.position_m[:, 2].max()) * KM * EXAGGERATION
    corners = np.concatenate([field_corners(place), field_corners(place, ceiling_km)])
    kind = 0 if panel.width > 1.6 * panel.height else 1
    overview = fit(corners, YAW_RAD[kind], TILT_RAD[kind], panel)
    action: list[Points | None] = [None] * len(times)
    for frame in np.flatnonzero(engaged([flight], times)):
        there = [body.path.position(float(times[frame])) for body in bodies if body.flies(float(times[frame]))]
        action[frame] = np.array(there)
    return [camera(pose, panel) for pose in camera_flight(overview, action, panel, per_s)]
