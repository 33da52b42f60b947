"""The kernel against the executable specification: two programs, written apart, fly the same engagements."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import sim.reference
import sim.reference_physics
from agents.expert import DraggingExpert
from sim.reference import ReferenceWorld
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, Policy, changed, circle, drag, random_turns, straight, task, wrapped

DEFAULT = load_scenario()
ANGLES = (2, 4, 5, 6)
SUBSTEP_S = 0.05


def fly_both(kernel: World, reference: ReferenceWorld, act: Policy | NDArray, steps: int) -> list[NDArray[np.int32]]:
    """Fly both by the turns that suit the kernel's flight until all lanes have ended; fates `[K, L, M]` of each."""
    fates: list[tuple[NDArray, NDArray]] = []
    for k in range(steps):
        turns = act(kernel.observation) if callable(act) else act[k]
        kernel.step(turns)
        reference.step(turns)
        fates.append((kernel.fate, reference.fate.copy()))
        if (kernel.outcome != Outcome.FLYING).all() and (reference.outcome != Outcome.FLYING).all():
            break
    return [np.stack(each) for each in zip(*fates, strict=True)]


def lanes_that_agree(kernel: World, reference: ReferenceWorld) -> NDArray[np.bool_]:
    """Lanes with the same outcome, killer and fates `[L]`."""
    same = (kernel.outcome == reference.outcome) & (kernel.killer == reference.killer)
    return same & (kernel.fate == reference.fate).all(axis=1)


def apart(first: NDArray, second: NDArray) -> NDArray:
    """Differences of observations: metres, and angles the short way round."""
    difference = first.astype(float) - second
    angles = [*ANGLES, *range(8, first.shape[1], 2)]
    difference[:, angles] = wrapped(difference[:, angles])
    return np.abs(difference)


def test_they_share_no_code_that_flies() -> None:
    for module in (sim.reference, sim.reference_physics):
        tree = ast.parse(Path(module.__file__ or "").read_text(encoding="utf-8"))
        imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
        imported |= {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
        assert not imported & {"sim.geometry", "warp"}
        assert not any(name.startswith("sim.kernel") for name in imported if name)


def test_300_engagements_end_alike() -> None:
    kernel, reference = World(task(), 300, seed=5), ReferenceWorld(task(), 300, seed=5)
    fates = fly_both(kernel, reference, drag, 400)
    assert lanes_that_agree(kernel, reference).all()
    # An exit or a hit within a hair of a decision step's end may be counted to the next one.
    assert abs(kernel.steps - reference.steps).max() <= 1
    assert (kernel.steps != reference.steps).sum() <= 2
    # All of that in more than one way:
    assert {Outcome.EXIT, Outcome.SHOT_DOWN, Outcome.LEFT_FIELD} <= set(kernel.outcome.tolist())
    assert set(np.unique(kernel.fate)) == set(Fate)
    # A missile whose speed grazes its limit may end a decision step or two apart after minutes in float32.
    differs = (fates[0] != fates[1]).any(axis=2)
    assert differs.sum(axis=0).max() <= 2
    assert differs.any(axis=0).sum() <= 6


@pytest.mark.parametrize("masked", [(1,), (2, 4)])
def test_masks_mean_the_same(masked: tuple[int, ...]) -> None:
    kernel, reference = World(task(*masked), 40, seed=3), ReferenceWorld(task(*masked), 40, seed=3)
    assert apart(kernel.observation, reference.observation).max() < 0.01
    fly_both(kernel, reference, drag, 100)
    assert lanes_that_agree(kernel, reference).all()
    assert kernel.observation.shape == reference.observation.shape
    assert (reference.fate[:, np.array(masked) - 1] == Fate.UNLAUNCHED).all()


def test_every_phase_of_the_default_engagement_goes_on_alike() -> None:
    """From the kernel's own state, all along whole engagements: one decision step gives the same everything."""
    kernel, expert = World(Task(DEFAULT), 200, seed=1), DraggingExpert()
    layout = kernel.task.layout
    events = 0
    while (kernel.outcome == Outcome.FLYING).any():
        turns, before = expert.act(kernel.observation, layout), kernel.fate
        if kernel.steps.max() % 12:
            kernel.step(turns)
            continue
        reference = ReferenceWorld.taking_over(kernel)
        ours, theirs = kernel.step(turns), reference.step(turns)
        assert lanes_that_agree(kernel, reference).all()
        np.testing.assert_allclose(ours.reward_terms, theirs.reward_terms, atol=1e-4)
        np.testing.assert_array_equal(ours.terminated, theirs.terminated)
        np.testing.assert_array_equal(ours.truncated, theirs.truncated)
        difference = apart(ours.observation, theirs.observation)
        assert difference[:, [0, 1, 3, *range(7, layout.size, 2)]].max() < 0.5
        assert difference[:, list(ANGLES)].max() < 2e-3
        events += int((kernel.fate != before).sum())
    assert events > 40


def test_a_minute_of_hard_random_manoeuvre_ends_in_the_same_place() -> None:
    turns = np.random.default_rng(2).uniform(-np.pi / 2, np.pi / 2, (60, 100)).astype(np.float32)
    scenario = changed(DRILL, missile={"fuse_m": 0.5}, rules={"outside_steps": 100})
    kernel, reference = World(Task(scenario), 100, seed=8), ReferenceWorld(Task(scenario), 100, seed=8)
    fates = fly_both(kernel, reference, turns, 60)
    np.testing.assert_array_equal(fates[0], fates[1])
    assert (kernel.fate[:, 0] != Fate.UNLAUNCHED).mean() > 0.5
    seen = apart(kernel.observation, reference.observation)
    assert seen[:, [0, 1, 3]].max() < 0.5
    assert seen[:, list(ANGLES)].max() < 1e-3
    ours = kernel.aircraft
    assert np.abs(ours["position"] - reference.aircraft.position).max() < 0.5
    assert np.abs(ours["speed"] - reference.aircraft.speed).max() < 0.05
    # Where the zone is entered within a hair of a substep's end, a launch and what follows come a substep later.
    flying, missiles = kernel.fate == Fate.FLYING, kernel.missiles
    together = np.abs(missiles["age"] - reference.missile.age) < SUBSTEP_S / 2
    assert together[flying].mean() > 0.95
    distance = np.abs(missiles["position"] - reference.missile.position).max(axis=2)
    assert distance[flying & together].max() < 0.5


@pytest.mark.parametrize(("act", "outcome"), [(circle, Outcome.TIMEOUT), (straight, Outcome.LEFT_FIELD)])
def test_the_rules_of_a_decision_step_end_alike(act: Policy, outcome: Outcome) -> None:
    scenario = changed(DRILL, rules={"max_steps": 260})
    harmless = Task(scenario, frozenset({1, 2, 3, 4}))
    kernel, reference = World(harmless, 20), ReferenceWorld(harmless, 20)
    fly_both(kernel, reference, act, 260)
    assert outcome in kernel.outcome
    assert lanes_that_agree(kernel, reference).all()
    np.testing.assert_array_equal(kernel.steps, reference.steps)


def test_lanes_are_reset_alike() -> None:
    kernel, reference = World(task(), 4, seed=6), ReferenceWorld(task(), 4, seed=6)
    fly_both(kernel, reference, random_turns(20, 4), 20)
    for world in (kernel, reference):
        world.reset(lanes=[2, 0])
        world.reset(lanes=np.array([False, True, False, False]), episodes=[99])
    assert apart(kernel.observation, reference.observation).max() < 0.05
    np.testing.assert_array_equal(kernel.steps, reference.steps)


def test_the_interval_between_launches_is_exact() -> None:
    scenario = changed(launch={"interval_s": 20.0, "range_m": 200e3, "radar_range_m": 200e3})
    kernel, reference = World(Task(scenario), 20, seed=4), ReferenceWorld(Task(scenario), 20, seed=4)
    fly_both(kernel, reference, straight, 22)
    second = kernel.fate[:, 1] != Fate.UNLAUNCHED
    assert second.any()
    ages_s = kernel.missiles["age"][second, 1]
    np.testing.assert_allclose(ages_s, reference.missile.age[second, 1], atol=SUBSTEP_S / 2)
