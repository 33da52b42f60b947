"""The world has no handedness: an engagement mirrored in y flies the mirrored engagement."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import sim.world
from sim.scenario import Scenario
from sim.start import initial_states
from sim.world import World
from tests.engagements import Flights, drag, fly_lanes, random_turns, task, wrapped

LANES = 32
ODD = ("y", "psi", "theta_AA", "theta_ATA", "phi_exit", "phi_1", "phi_2", "phi_3", "phi_4")
Y_AND_HEADING = [1, 3, 6, 8]


def mirrored_states(scenario: Scenario, seed: int, episodes: NDArray) -> NDArray[np.float32]:
    """Initial states with y and headings of both aircraft negated."""
    states = initial_states(scenario, seed, episodes)
    states[:, Y_AND_HEADING] *= -1.0
    return states


def pair(monkeypatch: pytest.MonkeyPatch, turns: NDArray) -> tuple[Flights, Flights]:
    """The same engagements, as drawn and mirrored."""
    plain = fly_lanes(World(task(), LANES, seed=6), turns, steps=len(turns))
    monkeypatch.setattr(sim.world, "initial_states", mirrored_states)
    return plain, fly_lanes(World(task(), LANES, seed=6), -turns, steps=len(turns))


def test_mirrored_engagements_fly_mirrored(monkeypatch: pytest.MonkeyPatch) -> None:
    turns = random_turns(300, LANES, seed=6)
    plain, mirror = pair(monkeypatch, turns)
    np.testing.assert_array_equal(plain.fates, mirror.fates)
    np.testing.assert_array_equal(plain.terms, mirror.terms)
    np.testing.assert_array_equal(plain.outcome, mirror.outcome)
    for column, name in enumerate(task().layout.names):
        a, b = plain.observation[..., column], mirror.observation[..., column]
        if name in ODD:
            default = name.startswith("phi_") and name != "phi_exit" and (plain.observation[..., column - 1] < 0.0)
            shift = np.where(default, 0.0, a + b)
            error = shift if name == "y" else wrapped(shift)
        else:
            error = a - b
        # Metres of ranges over tens of kilometres, or radians: rounding of float32 grows along a flight.
        assert abs(error).max() < (0.5 if name[0] in "xylr" else 5e-3), name


def test_a_world_that_leans_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # The negative control: forget to mirror the turns.
    turns = random_turns(300, LANES, seed=6)
    plain = fly_lanes(World(task(), LANES, seed=6), turns, steps=300)
    monkeypatch.setattr(sim.world, "initial_states", mirrored_states)
    wrong = fly_lanes(World(task(), LANES, seed=6), turns, steps=300)
    assert abs(plain.observation[..., 1] + wrong.observation[..., 1]).max() > 100.0


def test_a_policy_without_handedness_wins_as_often_mirrored(monkeypatch: pytest.MonkeyPatch) -> None:
    # Feedback amplifies rounding: single flights may part, their number may not.
    plain = fly_lanes(World(task(), 96, seed=6), drag)
    monkeypatch.setattr(sim.world, "initial_states", mirrored_states)
    mirror = fly_lanes(World(task(), 96, seed=6), drag)
    assert (plain.outcome == mirror.outcome).mean() > 0.95
