"""The lines of ACMI objects over a flight: what a body is, once, and where it is and how it does, frame by frame."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sim.geometry import azimuth
from sim.reference_physics import GRAVITY_M_S2, air
from sim.trajectory import BodyTrack, MissileTrack, Trajectory
from workbench.acmi.transform import number_texts, transforms

EVADER, INTERCEPTOR, EXIT, EXPLOSION = "a1", "b1", "e1", "f1"
"""Object ids: hexadecimal, and never used twice in a file."""

Texts = Mapping[str, Sequence[str]]
"""Values of a property, as text, by its name: one per row."""


def missile_id(number: int) -> str:
    """Object id of a missile (1-based)."""
    return f"c{number:x}"


def body_lines(flight: Trajectory, frames: NDArray[np.intp]) -> dict[int, list[str]]:
    """Lines of aircraft and missiles by frame, an index of `flight.time_s`; each body's first line says what it is."""
    by_frame: dict[int, list[str]] = {int(frame): [] for frame in frames}
    bodies = [_evader(flight, frames), _interceptor(flight, frames)]
    bodies += [_missile(missile, frames) for missile in flight.missiles]
    for lines in bodies:
        for frame, line in lines:
            by_frame[frame].append(line)
    return by_frame


def exit_lines(flight: Trajectory) -> list[str]:
    """The exit gate (Fig. 2): waypoints in its middle and at both ends."""
    field = flight.task.scenario.battlefield
    lines = []
    for number, (name, side) in enumerate([("Exit", 0), ("Exit north end", 1), ("Exit south end", -1)]):
        place = np.array([[field.length_m / 2, field.exit_y_m + side * field.exit_half_width_m, 0.0]])
        (value,) = transforms(place, np.array([math.pi / 2]), np.zeros(1))
        lines.append(f"e{1 + number},T={value},Type=Navaid+Static+Waypoint,Name={name},Color=Green")
    return lines


def explosion_line(flight: Trajectory) -> str:
    """A ball of fire where the evader was last seen."""
    seen = flown(flight.evader)[-1:]
    (value,) = transforms(flight.evader.position_m[seen], np.full(1, math.pi / 2), np.zeros(1))
    return f"{EXPLOSION},T={value},Type=Misc+Explosion,Name=Explosion,Color=Orange,Radius=20"


def flown(track: BodyTrack | MissileTrack) -> NDArray[np.intp]:
    """Indices of the instants at which a body has a place."""
    return np.flatnonzero(np.isfinite(track.position_m).all(axis=1))


def vertical_g(track: BodyTrack, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Load factor `[T]` [g] of a coordinated turn: what is felt across the path; 1 in straight and level flight."""
    if len(time_s) < 2:
        return np.ones(len(time_s))
    level = np.cos(track.pitch_rad)
    unit = np.stack([level * np.cos(track.heading_rad), level * np.sin(track.heading_rad), np.sin(track.pitch_rad)], 1)
    felt = np.gradient(unit * track.speed_m_s[:, None], time_s, axis=0)
    felt[:, 2] += GRAVITY_M_S2
    across = felt - (felt * unit).sum(axis=1, keepdims=True) * unit
    return np.linalg.norm(across, axis=1) / GRAVITY_M_S2


def _evader(flight: Trajectory, frames: NDArray[np.intp]) -> Iterable[tuple[int, str]]:
    statics = ["Type=Air+FixedWing", "Name=F-16C", "CallSign=Evader", f"Pilot={escaped(flight.policy)}"]
    statics += ["Color=Blue", "Coalition=Allies", "Health=1"]
    frames = np.intersect1d(frames, flown(flight.evader))
    paid, total = _rewards(flight, flight.time_s[frames])
    texts = {"Reward": number_texts(paid, 2), "Return": number_texts(total, 2)}
    return _lines(EVADER, statics, frames, flight.evader, _numbers(flight.evader, flight.time_s, frames) | texts)


def _interceptor(flight: Trajectory, frames: NDArray[np.intp]) -> Iterable[tuple[int, str]]:
    statics = ["Type=Air+FixedWing", "Name=F-16C", "CallSign=Interceptor", "Color=Red", "Coalition=Enemies"]
    statics += [f"LockedTarget={EVADER}"]
    frames = np.intersect1d(frames, flown(flight.interceptor))
    texts = {"LockedTargetMode": number_texts(_locked(flight, frames), 0)}
    track = flight.interceptor
    return _lines(INTERCEPTOR, statics, frames, track, _numbers(track, flight.time_s, frames) | texts)


def _missile(missile: MissileTrack, frames: NDArray[np.intp]) -> Iterable[tuple[int, str]]:
    statics = ["Type=Weapon+Missile", "Name=AIM-120C", f"CallSign=Missile {missile.number}"]
    statics += ["Color=Red", "Coalition=Enemies", f"Parent={INTERCEPTOR}", f"LockedTarget={EVADER}"]
    frames = np.intersect1d(frames, flown(missile))
    texts = {"TAS": number_texts(missile.speed_m_s[frames], 1), "Mach": _mach(missile, frames)}
    return _lines(missile_id(missile.number), [*statics, "LockedTargetMode=1"], frames, missile, texts)


def _numbers(track: BodyTrack, time_s: NDArray[np.float64], frames: NDArray[np.intp]) -> dict[str, list[str]]:
    pull = number_texts(vertical_g(track, time_s)[frames], 2)
    return {"TAS": number_texts(track.speed_m_s[frames], 1), "Mach": _mach(track, frames), "VerticalGForce": pull}


def _mach(track: BodyTrack | MissileTrack, frames: NDArray[np.intp]) -> list[str]:
    _density, sound_m_s = air(track.position_m[frames, 2])
    return number_texts(track.speed_m_s[frames] / sound_m_s, 3)


def _rewards(flight: Trajectory, time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Reward of the decision step that ended last, and the sum so far, at some times."""
    steps = flight.reward_terms.sum(axis=1)
    ends = np.minimum(flight.step_time_s + flight.task.scenario.rules.step_s, flight.time_s[-1])
    done = np.searchsorted(ends, time_s + 1e-6, side="right")
    return np.append(0.0, steps)[done], np.append(0.0, np.cumsum(steps))[done]


def _locked(flight: Trajectory, frames: NDArray[np.intp]) -> NDArray[np.float64]:
    """Whether the evader is inside the interceptor's radar, 1 or 0."""
    launch, hunter, prey = flight.task.scenario.launch, flight.interceptor, flight.evader
    distance = np.linalg.norm(prey.position_m[frames] - hunter.position_m[frames], axis=1)
    off_nose = azimuth(hunter.position_m[frames, :2], hunter.heading_rad[frames], prey.position_m[frames, :2])
    inside = (distance <= launch.radar_range_m) & (np.abs(off_nose) <= launch.radar_half_angle_rad)
    return inside.astype(np.float64)


def _lines(
    ident: str, statics: Sequence[str], frames: NDArray[np.intp], track: BodyTrack | MissileTrack, texts: Texts
) -> Iterable[tuple[int, str]]:
    """(frame, line): static properties on the first line, others when they are a number and have changed."""
    bank = track.bank_rad[frames] if isinstance(track, BodyTrack) else None
    places = transforms(track.position_m[frames], track.heading_rad[frames], track.pitch_rad[frames], bank)
    written: dict[str, str] = {}
    for row, (frame, place) in enumerate(zip(frames.tolist(), places, strict=True)):
        changed = {name: values[row] for name, values in texts.items() if values[row] not in ("nan", written.get(name))}
        written |= changed
        first = statics if row == 0 else ()
        yield frame, ",".join([ident, f"T={place}", *first, *(f"{name}={text}" for name, text in changed.items())])


def escaped(text: str) -> str:
    """A text as a property's value: one line, commas escaped, and no bar or backslash that would mean something."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    return plain.replace("|", "/").replace("\\", "/").replace(",", "\\,")
