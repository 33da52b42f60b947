"""Numbers that are not finite: an action is refused with a sentence, a state ends its lane under a name."""

from __future__ import annotations

import numpy as np
import pytest

from sim.errors import ActionError
from sim.trajectory import fly
from sim.world import Outcome, World
from tests.engagements import DRILL, changed, straight, task


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_an_action_that_is_not_finite_is_refused_and_nothing_moves(wrong: float) -> None:
    world = World(task(), 20)
    before = world.state()
    actions = np.zeros(20)
    actions[17] = wrong
    with pytest.raises(ActionError) as error:
        world.step(actions)
    assert str(error.value) == f"the action of lane 17 is {wrong}; legal is a finite turning angle in radians"
    for name, values in world.state().items():
        np.testing.assert_array_equal(values, before[name])
    world.step(np.zeros(20))
    assert (world.steps == 1).all()


def poisoned(lanes: int = 20, lane: int = 3) -> World:
    """A world in which the speed of one evader has become NaN."""
    world = World(task(), lanes)
    state = world.state()
    state["aircraft"][lane, 0, 6] = np.nan
    world.restore(state)
    return world


def test_a_state_that_is_not_finite_ends_its_lane_under_its_name() -> None:
    world, sound = poisoned(), World(task(), 20)
    step, expected = world.step(np.zeros(20)), sound.step(np.zeros(20))
    assert world.outcome[3] == Outcome.NOT_FINITE
    assert step.truncated[3]
    assert not step.terminated[3]
    assert (step.reward_terms[3] == 0.0).all()
    assert np.isfinite(step.observation).all()
    others = np.arange(20) != 3
    assert (world.outcome[others] == Outcome.FLYING).all()
    np.testing.assert_array_equal(step.observation[others], expected.observation[others])


def test_such_a_lane_flies_again_after_a_reset() -> None:
    world = poisoned()
    world.step(np.zeros(20))
    world.reset(lanes=[3], episodes=[3])
    np.testing.assert_array_equal(world.observation[3], World(task(), 4).observation[3])
    assert np.isfinite(world.step(np.zeros(20)).observation).all()
    assert world.outcome[3] == Outcome.FLYING


def test_a_world_that_blows_up_tells_so_in_its_flight() -> None:
    # Ten seconds a substep and a light aircraft with enormous thrust: legal numbers, no sane integration.
    wild = changed(
        DRILL, rules={"step_s": 10.0, "substeps": 1}, missile={"arm_s": 10.0},
        evader={"mass_kg": 100.0, "thrust_max_n": 1e6, "cd0": 0.5, "wing_area_m2": 200.0, "induced_drag": 2.0},
    )  # fmt: skip
    flight = fly(task(scenario=wild), straight, "test", 1)
    assert all(np.isfinite(a).all() for a in (flight.observation, flight.reward_terms, flight.evader.position_m))
    if flight.outcome is Outcome.NOT_FINITE:
        assert flight.events[-1].kind == "not_finite"
