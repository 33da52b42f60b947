"""Flights of the drill that end in each way, flown once for all tests of exports."""

from __future__ import annotations

from functools import cache

import pytest

from layouts.animation import HOLD_S
from sim.task import Task
from sim.trajectory import Trajectory, fly
from sim.world import Outcome
from tests.engagements import circle, drag, straight, task, to_exit
from workbench import export_video
from workbench.branch import Branch, fly_branch

POLICIES = {
    Outcome.EXIT: drag,
    Outcome.SHOT_DOWN: straight,
    Outcome.LEFT_FIELD: straight,
    Outcome.TIMEOUT: circle,
}
SEEDS = 40


@cache
def ending(outcome: Outcome, flown: Task | None = None) -> Trajectory:
    """The first flight, by seed, that ends so: with all missiles, or without any where those would end it first."""
    unarmed = outcome in (Outcome.LEFT_FIELD, Outcome.TIMEOUT)
    flown = flown or (task(1, 2, 3, 4) if unarmed else task())
    for seed in range(SEEDS):
        flight = fly(flown, POLICIES[outcome], f"{outcome.name.lower()} of a test", seed)
        if flight.outcome is outcome and (unarmed or flight.events[0].kind == "launch"):
            return flight
    raise AssertionError(f"no flight ends with {outcome.name}")


@cache
def branched() -> Trajectory:
    """The flight that is shot down, left by hand after 30 s: a minute of headings, then circles."""
    original = ending(Outcome.SHOT_DOWN)
    return fly_branch(original, Branch("B", 30, (90,) * 20 + (200,) * 40, "circle"), circle)


def unhindered() -> Trajectory:
    """To the exit with every missile masked; flown anew at every call, recorded every second."""
    return fly(task(1, 2, 3, 4), to_exit, "to the exit", 3, record_every=20)


def shorten_films(monkeypatch: pytest.MonkeyPatch) -> None:
    """Animations of a fifth of a second and the held last picture: enough to be read, and soon drawn."""
    for name in ("GIF_SECONDS", "MP4_SECONDS"):
        monkeypatch.setattr(export_video, name, HOLD_S + 0.2)
