"""Engagements as the record that the replay in one HTML file draws: bodies as columns, events, what was flown."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from layouts.battlefield import EXAGGERATION, drawing_scale
from layouts.cameras import AHEAD_KM, FIELD_OF_VIEW_RAD, LOOKBACK_S, TOP_TILT_RAD
from layouts.captions import caption, closest_miss_m, distance_text, name_text, outcome_text, policy_text
from layouts.flight_figure import engagement_s
from layouts.flight_panels import event_colour
from layouts.letters import LETTERS, evader_inks, letters
from layouts.meshes import Mesh, aircraft, missile
from layouts.scene import AIRCRAFT_KM, MISSILE_KM
from layouts.theme import (
    DARK,
    DASHED,
    FAILURE,
    GATE,
    INTERCEPTOR,
    LIGHT,
    Ground,
    missile_colour,
)
from sim.trajectory import BodyTrack, MissileTrack, Trajectory
from sim.world import Fate, Outcome
from workbench.flight_table import facts

FORMAT = "submas-replay/1"
BEHIND_KM, ABOVE_KM, BELOW_KM = 46.0, 30.0, 11.0
"""Of the camera that follows an evader: how far behind and above it, and how far below it the middle of the view is.
Higher than on a page, so that missiles behind it are seen apart."""

AIRCRAFT_SAMPLE_S, MISSILE_SAMPLE_S = 0.5, 0.1
"""Spacing of what is kept of a path; straight lines between stay within some metres of it."""

VERSIONS = ("submas-workbench", "warp-lang", "numpy")


def title_of(flights: Sequence[Trajectory]) -> str:
    """Who flew what, in one line."""
    *first, last = flights
    return " and ".join([*map(policy_text, first), caption(last)])


def replay_record(flights: Sequence[Trajectory]) -> dict[str, Any]:
    """Flights of one scenario as JSON: positions in metres, angles in degrees, times in seconds."""
    field = flights[0].task.scenario.battlefield
    windows = [engagement_s(flight) for flight in flights]
    duration_s = max(flight.duration_s for flight in flights)
    highest_m = max(float(np.nanmax(flight.evader.position_m[:, 2])) for flight in flights)
    return {
        "format": FORMAT,
        "made_with": versions(),
        "field": {
            "length_km": field.length_m / 1e3,
            "width_km": field.width_m / 1e3,
            "exit_y_km": field.exit_y_m / 1e3,
            "exit_half_width_km": field.exit_half_width_m / 1e3,
        },
        "exaggeration": EXAGGERATION,
        "ceiling_km": round(highest_m / 1e3 * EXAGGERATION, 3),
        "scale": round(drawing_scale(field), 4),
        "duration_s": _short(duration_s),
        "engagement_s": [min(low for low, _ in windows), max(high for _, high in windows)],
        "cameras": _cameras(),
        "grounds": {"dark": _ground(DARK), "light": _ground(LIGHT)},
        "inks": {"gate": GATE, "failure": FAILURE},
        "meshes": {"aircraft": _mesh(aircraft()), "missile": _mesh(missile())},
        "flights": [_flight(*each) for each in zip(flights, letters(flights), evader_inks(flights), strict=True)],
    }


def versions() -> dict[str, str]:
    """What the flights were computed with."""
    return {name: metadata.version(name) for name in VERSIONS} | {"python": platform.python_version()}


def _flight(flight: Trajectory, letter: str, ink: str) -> dict[str, Any]:
    scale = drawing_scale(flight.task.scenario.battlefield)
    shot = flight.outcome is Outcome.SHOT_DOWN
    plane = {"mesh": "aircraft", "size_km": round(AIRCRAFT_KM * scale, 3), "missile": 0, "dashed": False}
    bodies = [
        plane | {"ink": ink, "gone_s": _short(flight.duration_s) if shot else None} | _columns(flight, flight.evader),
        plane | {"ink": INTERCEPTOR, "gone_s": None} | _columns(flight, flight.interceptor),
    ]
    flown = [track for track in flight.missiles if np.isfinite(track.launch_s)]
    bodies += [_missile(flight, track, scale) for track in flown]
    miss_m = closest_miss_m(flight)
    return {
        "letter": letter,
        "name": name_text(flight, beside=bool(letter)),
        **_branch(flight, letter),
        "facts": facts(flight),
        "success": flight.success,
        "outcome": outcome_text(flight),
        "closest": distance_text(miss_m) if np.isfinite(miss_m) else "",
        "bodies": bodies,
        "marks": [_mark(flight, track) for track in flown if track.fate in (Fate.EVADED, Fate.HIT)],
        "events": [
            {"time_s": _short(e.time_s), "kind": e.kind, "missile": e.missile, "text": e.text, "ink": event_colour(e)}
            for e in flight.events
        ],
    }


def _branch(flight: Trajectory, letter: str) -> dict[str, Any]:
    """On the field of which flight (0, 1) a branch is drawn, and from when on; alone, a flight is drawn whole."""
    left = flight.departure if letter else None
    return {"branch_of": LETTERS.index(left.of), "branch_s": _short(left.time_s)} if left else {"branch_of": None}


def _missile(flight: Trajectory, track: MissileTrack, scale: float) -> dict[str, Any]:
    ink = missile_colour(track.number)
    return {
        "mesh": "missile",
        "size_km": round(MISSILE_KM * scale, 3),
        "missile": track.number,
        "ink": ink,
        "dashed": ink in DASHED,
        "gone_s": _short(track.end_s) if np.isfinite(track.end_s) else None,
    } | _columns(flight, track)


def _columns(flight: Trajectory, track: BodyTrack | MissileTrack) -> dict[str, list[float]]:
    """Samples of a track in flight; angles run on beyond a whole turn, so that what lies between can be drawn."""
    kept = _kept(flight, track)
    columns = {"time_s": _rounded(flight.time_s[kept], 3)}
    columns |= {
        name: _rounded(track.position_m[kept, axis], 0) for axis, name in enumerate(("x_m", "y_m", "altitude_m"))
    }
    columns["heading_deg"] = _rounded(np.degrees(np.unwrap(track.heading_rad[kept])), 1)
    columns["pitch_deg"] = _rounded(np.degrees(track.pitch_rad[kept]), 1)
    columns["speed_m_s"] = _rounded(track.speed_m_s[kept], 0)
    if isinstance(track, BodyTrack):
        return columns | {"bank_deg": _rounded(np.degrees(np.unwrap(track.bank_rad[kept])), 1)}
    azimuth = _rounded(np.degrees(track.azimuth_rad[kept]), 1)
    return columns | {"range_m": _rounded(track.range_m[kept], 0), "azimuth_deg": azimuth}


def _kept(flight: Trajectory, track: BodyTrack | MissileTrack) -> NDArray[np.intp]:
    flown = np.flatnonzero(np.isfinite(track.position_m[:, 0]))
    wanted_s = AIRCRAFT_SAMPLE_S if isinstance(track, BodyTrack) else MISSILE_SAMPLE_S
    spacing_s = float(np.median(np.diff(flight.time_s))) if len(flight.time_s) > 1 else wanted_s
    kept = [flown[:: max(1, round(wanted_s / spacing_s))], flown[-1:]]
    if isinstance(track, MissileTrack):
        kept.append(np.array([np.nanargmin(track.range_m)]))
    return np.unique(np.concatenate(kept))


def _mark(flight: Trajectory, track: MissileTrack) -> dict[str, Any]:
    last = track.position_m[np.flatnonzero(np.isfinite(track.position_m[:, 0]))[-1]]
    hit = track.fate is Fate.HIT
    place = dict(zip(("x_m", "y_m", "altitude_m"), _rounded(last, 0), strict=True))
    kind = "hit" if hit else "evaded"
    return {"time_s": _short(track.end_s), "kind": kind, "ink": missile_colour(track.number)} | place


def _cameras() -> dict[str, float]:
    return {
        "field_of_view_rad": FIELD_OF_VIEW_RAD, "top_tilt_rad": TOP_TILT_RAD, "behind_km": BEHIND_KM,
        "above_km": ABOVE_KM, "below_km": BELOW_KM, "ahead_km": AHEAD_KM, "lookback_s": LOOKBACK_S,
    }  # fmt: skip


def _ground(look: Ground) -> dict[str, Any]:
    far = (255, 255, 255) if look is DARK else (0, 0, 0)
    colours = {name: getattr(look, name) for name in ("background", "field", "grid", "border")}
    return colours | {"far": far, "lift": look.lift}


def _mesh(mesh: Mesh) -> dict[str, list[list[float]]]:
    return {"vertices": mesh.vertices.astype(float).round(4).tolist(), "faces": mesh.faces.tolist()}


def _rounded(values: NDArray[np.floating], digits: int) -> list[float]:
    rounded = values.astype(float).round(digits)
    return [int(value) for value in rounded] if digits == 0 else rounded.tolist()


def _short(seconds: float) -> float:
    return round(float(seconds), 3)
