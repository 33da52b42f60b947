"""What happens in an engagement as ACMI 2.2 events: launches, outcomes for the shot log, kills, and departures."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from sim.trajectory import Event, MissileTrack, Trajectory
from sim.world import Fate, Outcome
from workbench.acmi.bodies import EVADER, INTERCEPTOR, escaped, explosion_line, flown, missile_id


def event_lines(flight: Trajectory) -> dict[int, list[str]]:
    """Lines by frame, an index of `flight.time_s`, to be written after the bodies' own lines of that frame.

    In a frame, words come first, then what they tell of: outcomes, the kill, departures, removals.
    """
    lines: dict[int, list[str]] = defaultdict(list)
    for event in flight.events:
        lines[_frame(flight, event.time_s)].append(_words(event))
    removed: dict[int, list[str]] = defaultdict(list)
    for missile in flight.missiles:
        seen = flown(missile)
        if len(seen):
            lines[int(seen[-1])] += _outcome(missile)
            removed[int(seen[-1])].append(f"-{missile_id(missile.number)}")
    last = len(flight.time_s) - 1
    departure = _evader_end(flight)
    if departure:
        lines[last] += departure
        removed[last].append(f"-{EVADER}")
    return {frame: [*lines[frame], *removed[frame]] for frame in lines}


def _frame(flight: Trajectory, time_s: float) -> int:
    """Index of the recorded instant nearest to a time."""
    return int(np.abs(flight.time_s - time_s).argmin())


def _words(event: Event) -> str:
    text = escaped(event.text)
    if event.kind == "launch":
        return f"0,Event=Message|{INTERCEPTOR}|Fox 3: {text}"
    if event.kind == "evaded":
        return f"0,Event=Message|{EVADER}|{text}"
    return f"0,Event=Bookmark|{text}"


def _outcome(missile: MissileTrack) -> list[str]:
    """A missile that was still in flight when the episode ended has missed: it can hit nobody any more."""
    hit = missile.fate is Fate.HIT
    shot = f"SourceId:{INTERCEPTOR}|AmmoType:FOX3|AmmoCount:1|TargetId:{EVADER}|IntendedTarget:Evader"
    lines = [f"0,Event=Timeout|{shot}|Outcome:{'Kill' if hit else 'Miss'}"]
    # What has left did not explode; without this Tacview would take its removal for a destruction.
    return lines if hit else [*lines, f"0,Event=LeftArea|{missile_id(missile.number)}|"]


def _evader_end(flight: Trajectory) -> list[str]:
    """How the evader goes; nothing when it is still there at the end."""
    if flight.outcome is Outcome.SHOT_DOWN:
        words = next((event.text for event in flight.events if event.kind == "shot_down"), "shot down")
        destroyed = f"0,Event=Destroyed|{EVADER}|{escaped(words)}"
        return [f"{EVADER},Health=0", destroyed, explosion_line(flight)]
    if flight.outcome in (Outcome.EXIT, Outcome.LEFT_FIELD):
        return [f"0,Event=LeftArea|{EVADER}|"]
    return []
