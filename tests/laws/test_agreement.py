"""Law: the kernel flies as the float64 reference does: same fates, same event times, same places after a minute.

512 random engagements in two worlds, everything drawn: where they start, at which heading, height and speed, and what
the evader does (a third draws a new hard turn every second, a third holds each for seconds, a third drags as the expert
does). Both programs get the same turns.
"""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.scenario import Scenario
from sim.task import Task
from sim.world import Fate, Outcome
from tests.engagements import changed
from tests.laws.records import NEVER, SCENARIOS, Record, fly_kernel, fly_reference, hard_turns

SEED = 20
LANES = 256
STEPS = {"default": 280, "drill": 240}
DRAGS = np.arange(LANES) % 3 == 2

SUBSTEPS = 1
"""How far apart the times of an event may be."""
REWARD = 1e-3
POSITION_M = 0.5
"""Distance after a minute, of anything."""
BORDERLINES = 2
"""Engagements in 256 that may differ, if the reference itself cannot decide them."""
NUDGE_M = 0.5
NUDGES = 24
"""A borderline engagement is one that the reference ends otherwise when the aircraft start so far elsewhere."""


@cache
def flown(name: str) -> tuple[NDArray, Record, Record]:
    """Turns `[K, L]`, the kernel's record and the reference's."""
    task, turns = Task(SCENARIOS[name]), hard_turns(STEPS[name], LANES, SEED)
    kernel = fly_kernel(task, turns, SEED, drags=DRAGS)
    return turns, kernel, fly_reference(task, turns, SEED)


def disagreements(kernel: Record, reference: Record) -> dict[int, list[str]]:
    """What differs by more than the law allows: fates, ends, rewards, and when things happened, by lane."""
    allowed = {"launched": SUBSTEPS, "ended": SUBSTEPS, "over": SUBSTEPS, "reward": REWARD}
    found: dict[int, list[str]] = {}
    for name in ("launched", "ended", "over", "fate", "outcome", "killer", "reward"):
        ours, theirs = getattr(kernel, name).astype(float), getattr(reference, name).astype(float)
        for where in np.argwhere(np.abs(ours - theirs) > allowed.get(name, 0)):
            place = tuple(where.tolist())
            found.setdefault(place[0], []).append(f"{name}{list(place)} is {ours[place]:g}, not {theirs[place]:g}")
    return found


def borderline(name: str, lane: int) -> bool:
    """Whether the reference, started half a metre elsewhere, can end an engagement in the kernel's way."""
    turns, kernel, _ = flown(name)
    moved = np.random.default_rng(lane).uniform(-NUDGE_M, NUDGE_M, (NUDGES, 2, 3))
    again = np.repeat(turns[:, [lane]], NUDGES, axis=1)
    copies = fly_reference(Task(SCENARIOS[name]), again, SEED, nudged=(lane, moved))
    as_kernel = kernel.lanes(np.full(NUDGES, lane))
    return len(disagreements(as_kernel, copies)) < NUDGES


def apart(kernel: Record, reference: Record) -> tuple[NDArray, NDArray]:
    """Distances [m] after a minute: aircraft `[L, 2]`, missiles fired in the same substep `[L, M]`; NaN for none."""
    together = kernel.launched == reference.launched
    missiles = np.linalg.norm(kernel.missile_m - reference.missile_m, axis=-1)
    return np.linalg.norm(kernel.aircraft_m - reference.aircraft_m, axis=-1), np.where(together, missiles, np.nan)


def agrees(kernel: Record, reference: Record) -> bool:
    """The law, for engagements without borderlines."""
    near = [not (distances >= POSITION_M).any() for distances in apart(kernel, reference)]
    return all(near) and not disagreements(kernel, reference)


@pytest.mark.parametrize("name", SCENARIOS)
def test_fates_are_the_same_and_events_at_most_a_substep_apart(name: str) -> None:
    _, kernel, reference = flown(name)
    differing = disagreements(kernel, reference)
    assert len(differing) <= BORDERLINES, differing
    for lane, differences in differing.items():
        assert borderline(name, lane), f"{name}, lane {lane}: {differences}"


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_minute_of_hard_manoeuvre_ends_within_half_a_metre(name: str) -> None:
    aircraft, missiles = apart(*flown(name)[1:])
    assert np.nanmax(aircraft) < POSITION_M
    assert np.nanmax(missiles) < POSITION_M
    assert np.isfinite(aircraft).sum() > 250
    assert np.isfinite(missiles).sum() > 200


def test_these_engagements_have_everything_that_can_happen() -> None:
    records = [flown(name)[1] for name in SCENARIOS]
    assert {*np.concatenate([record.outcome for record in records])} == {
        Outcome.FLYING,
        Outcome.EXIT,
        Outcome.SHOT_DOWN,
        Outcome.LEFT_FIELD,
    }
    assert sum((record.launched != NEVER).sum() for record in records) > 1000
    for fate in (Fate.EVADED, Fate.HIT):
        assert sum((record.fate == fate).sum() for record in records) > 100


DULL = {
    "exit_half_width_m": 0.02, "radar_range_m": 0.3, "radar_half_angle_rad": 0.05, "range_min_m": 10.0, "fuse_m": 8.0,
    "arm_s": 20.0, "age_max_s": 0.2, "opening_m": 0.1, "lag_s": 1.1, "load_factor_max": 0.8, "substeps": 1.05,
    "full_load_pressure_pa": 2.0, "max_steps": 0.3, "outside_steps": 1.1,
}  # fmt: skip
"""Factors on numbers of which a fiftieth more would rarely change a flight."""
WRONG = [
    (section, field.name)
    for section in ("battlefield", "evader", "interceptor", "launch", "missile", "variation", "rules", "reward")
    for field in dataclasses.fields(getattr(SCENARIOS["drill"], section))
    if field.name != "missiles"
]


def flown_again(scenario: Scenario) -> bool:
    """Whether a kernel with this scenario's numbers agrees with the drill's reference, on lanes that show it all."""
    turns, kernel, reference = flown("drill")
    lanes = np.union1d(np.arange(80), np.flatnonzero(kernel.outcome == Outcome.EXIT))
    again = fly_kernel(Task(scenario), turns[:, lanes], SEED, episodes=lanes)
    return agrees(again, reference.lanes(lanes))


def test_the_right_numbers_agree() -> None:
    assert flown_again(SCENARIOS["drill"])


@pytest.mark.parametrize(("section", "name"), WRONG)
def test_a_kernel_with_one_number_wrong_by_a_fiftieth_would_be_noticed(section: str, name: str) -> None:
    # The negative control, for every number there is: the reference keeps the right one.
    right = getattr(getattr(SCENARIOS["drill"], section), name)
    wrong = type(right)(right * DULL.get(name, 1.02)) if right else 6e3
    assert wrong != right
    assert not flown_again(changed(SCENARIOS["drill"], **{section: {name: wrong}}))


def test_an_engagement_that_float32_can_decide_is_no_borderline() -> None:
    # The negative control of the excuse: a hit written as a miss is not excused.
    _, kernel, reference = flown("drill")
    lane = int(np.where(kernel.outcome == Outcome.SHOT_DOWN, kernel.over, np.inf).argmin())
    assert lane not in disagreements(kernel, reference)
    missile = int(kernel.killer[lane]) - 1
    kernel.fate[lane, missile] = Fate.EVADED
    assert not borderline("drill", lane)
    kernel.fate[lane, missile] = Fate.HIT
    assert borderline("drill", lane)
