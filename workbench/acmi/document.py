"""An engagement as a Tacview recording: ACMI 2.2 text, https://www.tacview.net/documentation/acmi/."""

from __future__ import annotations

import importlib.metadata
import io
import zipfile

import numpy as np
from numpy.typing import NDArray

from layouts.captions import caption, outcome_text
from sim.trajectory import Trajectory
from sim.world import Outcome
from workbench.acmi.bodies import EXPLOSION, body_lines, escaped, exit_lines, flown
from workbench.acmi.events import event_lines

NEAR_S, FAR_S = 0.1, 0.25
"""Seconds between frames while a missile flies, and while none does: straight lines between frames stay within 1 m."""

NOON = "2026-01-01T12:00:00Z"
"""When flights begin: any day, at noon, so that the scene is lit; constant, so that equal flights give equal files."""

BURNS_S = 2.0
"""How long an explosion is shown after the last instant of the flight."""


def acmi_text(flight: Trajectory) -> str:
    """The recording: header, then per frame the aircraft and missiles, what happened, and what is gone."""
    frames = frame_index(flight)
    bodies, happened = body_lines(flight, frames), event_lines(flight)
    lines = header(flight)
    for frame in frames.tolist():
        lines.append(f"#{flight.time_s[frame]:.3f}")
        lines += exit_lines(flight) if frame == 0 else []
        lines += [*bodies[frame], *happened.get(frame, [])]
    if flight.outcome is Outcome.SHOT_DOWN:
        lines += [f"#{flight.duration_s + BURNS_S:.3f}", f"-{EXPLOSION}"]
    return "\n".join(lines) + "\n"


def zipped_acmi(flight: Trajectory) -> bytes:
    """The recording as Tacview's `.zip.acmi`: an archive with one text; about a tenth of the size."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("flight.txt.acmi"), acmi_text(flight), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def header(flight: Trajectory) -> list[str]:
    """The two fixed lines, and the properties of the whole recording."""
    scenario = flight.task.scenario
    result = f"{outcome_text(flight)}, return {flight.episode_return:.1f}"
    properties = {
        "ReferenceTime": NOON,
        "Title": caption(flight),
        "Category": "Missile evasion",
        "DataSource": "SubMas workbench, simulated",
        "DataRecorder": f"submas-workbench {importlib.metadata.version('submas-workbench')}",
        "Comments": f"scenario {scenario.name} ({scenario.digest}), {result}",
        "ReferenceLongitude": "0",
        "ReferenceLatitude": "0",
    }
    first = ["FileType=text/acmi/tacview", "FileVersion=2.2"]
    return first + [f"0,{name}={escaped(value)}" for name, value in properties.items()]


def frame_index(flight: Trajectory) -> NDArray[np.intp]:
    """Ascending indices of the recorded instants that are written: evenly spread, and all where something happens."""
    tracks = [flown(missile) for missile in flight.missiles]
    near = np.zeros(len(flight.time_s), dtype=bool)
    for track in tracks:
        near[track] = True
    # A thousandth of a step of slack: 0.3 is a little less than three tenths.
    due = np.floor(flight.time_s / np.where(near, NEAR_S, FAR_S) + 1e-3)
    spread = np.flatnonzero(np.diff(due, prepend=-1.0))
    ends = [index for track in tracks if len(track) for index in (track[0], track[-1])]
    # In the substep of a kill, missiles that were due after the killer have not moved any more: a kink in their path.
    last = len(flight.time_s) - 1
    told = np.array([*ends, *event_lines(flight), max(last - 1, 0), last], dtype=np.intp)
    return np.union1d(spread, told)
