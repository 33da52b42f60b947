"""Law: the world has no handedness: an engagement mirrored in y flies the mirrored engagement, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from sim.observation import OWN_NAMES, UNLAUNCHED
from sim.scenario import Scenario
from sim.start import initial_states
from sim.world import Outcome, Step, World
from tests.engagements import Flights, Policy, changed, drag, fly_lanes, task
from tests.laws.records import SCENARIOS, hard_turns

LANES, STEPS, SEED = 48, 240, 6
ODD = [OWN_NAMES.index(name) for name in ("y", "psi", "theta_AA", "theta_ATA", "phi_exit")]
Y_AND_HEADING = [1, 3, 6, 8]
TURNS = hard_turns(STEPS, LANES, SEED)


def mirrored_states(scenario: Scenario, seed: int, episodes: NDArray) -> NDArray[np.float32]:
    """Initial states with y and headings of both aircraft negated."""
    states = initial_states(scenario, seed, episodes)
    states[:, Y_AND_HEADING] *= -1.0
    return states


def mirrored(observation: NDArray[np.float32]) -> NDArray[np.float32]:
    """Observations `[..., d]` as the mirror shows them; what does not fly looks the same in it."""
    shown = observation.copy()
    shown[..., ODD] *= -1.0
    blocks = shown[..., len(OWN_NAMES) :].reshape(*shown.shape[:-1], -1, 2)
    flying = blocks[..., 0] != UNLAUNCHED[0]
    blocks[..., 1] = np.where(flying, -blocks[..., 1], blocks[..., 1])
    return shown


def pair(world: type[World], scenario: Scenario, left: NDArray, right: NDArray) -> tuple[Flights, Flights]:
    """The same engagements by turns `[K, L]`, as drawn and mirrored."""
    worlds = [world(task(scenario=scenario), LANES, seed=SEED) for _ in range(2)]
    worlds[1].reset(states=mirrored_states(scenario, SEED, np.arange(LANES)))
    return fly_lanes(worlds[0], left, steps=len(left)), fly_lanes(worlds[1], right, steps=len(right))


def symmetric(plain: Flights, mirror: Flights) -> bool:
    """The law."""
    same = [np.array_equal(getattr(plain, name), getattr(mirror, name)) for name in ("fates", "terms", "outcome")]
    return all(same) and np.array_equal(mirrored(plain.observation), mirror.observation)


@pytest.mark.parametrize("name", SCENARIOS)
def test_mirrored_engagements_fly_mirrored(name: str) -> None:
    plain, mirror = pair(World, SCENARIOS[name], TURNS, -TURNS)
    assert symmetric(plain, mirror)
    assert {Outcome.SHOT_DOWN, Outcome.LEFT_FIELD} <= set(plain.outcome.tolist())


def test_turns_that_are_not_mirrored_would_be_noticed() -> None:
    assert not symmetric(*pair(World, SCENARIOS["drill"], TURNS, TURNS))


class LeaningWorld(World):
    """Every turn goes a ten-thousandth of a radian further to the left."""

    def step(self, actions: ArrayLike) -> Step:
        return super().step(np.asarray(actions) + 1e-4)


def test_a_world_that_leans_would_be_noticed() -> None:
    assert not symmetric(*pair(LeaningWorld, SCENARIOS["drill"], TURNS, -TURNS))


def test_an_exit_beside_the_middle_would_be_noticed() -> None:
    aside = changed(SCENARIOS["drill"], battlefield={"exit_y_m": 1.0})
    assert not symmetric(*pair(World, aside, TURNS, -TURNS))


def test_a_policy_without_handedness_fares_the_same_mirrored() -> None:
    # Closed loop: what it sees is mirrored exactly, so what it does is too.
    act: Policy = drag
    worlds = [World(task(), 96, seed=SEED) for _ in range(2)]
    worlds[1].reset(states=mirrored_states(task().scenario, SEED, np.arange(96)))
    plain, mirror = (fly_lanes(world, act) for world in worlds)
    assert (plain.outcome == mirror.outcome).mean() > 0.98
