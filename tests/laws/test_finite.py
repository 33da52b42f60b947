"""Law: no number that leaves the world is ever NaN or infinite; a state that is ends its lane under a name."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.errors import ActionError, UsageError
from sim.task import Task
from sim.world import Fate, Outcome, World
from tests.engagements import MASKS, Flights, Policy, drag, fly_lanes, straight, task, to_exit
from tests.laws.random_worlds import wild_scenario
from tests.laws.records import SCENARIOS, hard_turns
from tests.laws.tracks import zigzag

LANES = 16


def finite(*arrays: NDArray) -> bool:
    """The check."""
    return all(bool(np.isfinite(array).all()) for array in arrays)


def sound(world: World, flights: Flights) -> bool:
    """Whether all that a world gave is finite, and what still flies or has ended under another name is too."""
    named = world.outcome != Outcome.NOT_FINITE
    fired = (world.fate != Fate.UNLAUNCHED) & named[:, None]
    bodies = [*world.aircraft.values(), *(each[fired] for each in world.missiles.values())]
    return finite(flights.observation, flights.terms, *bodies)


@pytest.mark.parametrize("act", [drag, straight, to_exit, zigzag], ids=lambda act: act.__name__)
@pytest.mark.parametrize("masked", MASKS, ids=lambda masked: ",".join(map(str, sorted(masked))) or "none")
def test_no_number_of_any_task_is_nan_or_infinite(masked: frozenset[int], act: Policy) -> None:
    world = World(task(*masked), LANES, seed=9)
    assert sound(world, fly_lanes(world, act))
    assert Outcome.NOT_FINITE not in world.outcome


@pytest.mark.parametrize("name", SCENARIOS)
def test_hard_steering_gives_no_nan(name: str) -> None:
    world = World(Task(SCENARIOS[name]), 256, seed=9)
    assert sound(world, fly_lanes(world, hard_turns(300, 256, seed=1), steps=300))
    assert Outcome.NOT_FINITE not in world.outcome


def test_worlds_that_are_only_legal_give_no_nan_either() -> None:
    # Some of them cannot be integrated, such as ten seconds a substep or a hundred kilograms on a million newtons.
    void = 0
    for number in range(150):
        world = World(Task(wild_scenario(np.random.default_rng(number))), LANES, seed=number)
        assert sound(world, fly_lanes(world, hard_turns(60, LANES, seed=number), steps=60)), number
        void += int((world.outcome == Outcome.NOT_FINITE).sum())
    assert 0 < void < 0.05 * 150 * LANES


def test_a_state_that_is_not_finite_ends_its_lane_by_name_and_no_other() -> None:
    world = World(task(), LANES)
    state = world.state()
    state["missile"][5, 0, 3], state["fate"][5, 0] = np.inf, Fate.FLYING
    state["aircraft"][3, 0, 0] = np.nan
    world.restore(state)
    step = world.step(np.zeros(LANES))
    assert np.flatnonzero(world.outcome == Outcome.NOT_FINITE).tolist() == [3, 5]
    assert step.truncated[[3, 5]].all()
    assert not step.terminated.any()
    assert finite(step.observation[5], step.reward_terms)
    assert (np.delete(world.outcome, [3, 5]) == Outcome.FLYING).all()


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_an_action_that_is_not_finite_is_refused_with_a_sentence(wrong: float) -> None:
    world, actions = World(task(), LANES), np.zeros(LANES)
    actions[7] = wrong
    with pytest.raises(ActionError, match=f"lane 7 is {wrong}; legal is a finite turning angle"):
        world.step(actions)
    assert issubclass(ActionError, UsageError)
    assert (world.steps == 0).all()


def test_a_nan_would_be_noticed() -> None:
    world = World(task(), LANES, seed=9)
    flights = fly_lanes(world, drag)
    assert sound(world, flights)
    flights.observation[2, 3, 4] = np.nan
    assert not sound(world, flights)
    flights.observation[2, 3, 4] = -np.inf
    assert not sound(world, flights)
