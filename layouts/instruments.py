"""What the read-outs over the replay need of one flight: short series that the browser interpolates; no round trips."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from layouts.captions import distance_text
from layouts.closure import closure_m_s, interceptor_range_m
from layouts.controls import GuideTrace, load_factor
from layouts.energy import energy_share
from layouts.theme import missile_colour
from sim.trajectory import MissileTrack, Trajectory
from sim.world import Fate

EVADER_EVERY_S = 1.0
MISSILE_EVERY_S = 0.5


def instrument_series(flight: Trajectory, letter: str, colour: str, guide: GuideTrace | None = None) -> dict[str, Any]:
    """Everything the read-outs show, as plain JSON.

    `every` [s] spaces the series of the evader and the interceptor from time 0 on, and those of a missile from its
    `launch` on; `turn` and `guide` [deg] have one value per decision step of `step` [s]. Speeds are in m/s, loads in
    g, angles in degrees (left positive), ranges in km, energies in percent of the missile's greatest.
    """
    time = flight.time_s
    sampled = np.arange(0.0, flight.duration_s + EVADER_EVERY_S, EVADER_EVERY_S).clip(max=flight.duration_s)
    gap_m = interceptor_range_m(flight)
    series = {
        "speed": flight.evader.speed_m_s,
        "load": load_factor(flight.evader, time),
        "bank": np.degrees(flight.evader.bank_rad),
        "range": gap_m / 1e3,
        "closure": closure_m_s(gap_m, time),
    }
    shown = {name: _rounded(np.interp(sampled, time, values)) for name, values in series.items()}
    return {
        "letter": letter,
        "colour": colour,
        "every": EVADER_EVERY_S,
        "end": flight.duration_s,
        "step": flight.task.scenario.rules.step_s,
        "turn": _rounded(np.degrees(flight.action_rad)),
        "guide": None if guide is None else _rounded(np.degrees(guide.action_rad)),
        "allowed": None if guide is None else [bool(held) for held in guide.allowed],
        **shown,
        "missiles": [_missile(track, time) for track in flight.missiles if math.isfinite(track.launch_s)],
    }


def _missile(track: MissileTrack, time_s: NDArray[np.float64]) -> dict[str, Any]:
    known = np.flatnonzero(np.isfinite(track.range_m) & np.isfinite(track.azimuth_rad))
    begin, end = float(time_s[known[0]]), float(time_s[known[-1]])
    sampled = np.arange(begin, end + MISSILE_EVERY_S, MISSILE_EVERY_S).clip(max=end)
    angle = np.unwrap(track.azimuth_rad[known])  # the browser interpolates, then wraps
    series = {
        "range": track.range_m[known] / 1e3,
        "closure": closure_m_s(track.range_m, time_s)[known],
        "azimuth": np.degrees(angle),
        "energy": 100.0 * energy_share(track)[known],
    }
    shown = {name: _rounded(np.interp(sampled, time_s[known], values)) for name, values in series.items()}
    return {
        "number": track.number,
        "colour": missile_colour(track.number),
        "launch": begin,
        "end": end,
        "every": MISSILE_EVERY_S,
        "closest": float(time_s[known][np.argmin(track.range_m[known])]),
        "miss": distance_text(track.closest_m),
        "fate": {Fate.HIT: "hit", Fate.EVADED: "evaded"}.get(track.fate, "flying"),
        **shown,
    }


def _rounded(values: NDArray[np.floating]) -> list[float]:
    return [round(float(value), 2) for value in np.nan_to_num(values)]
