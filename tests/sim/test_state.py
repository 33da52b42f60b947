"""States of a world can be taken and put back: a flight goes on as if nothing had happened, in any lane."""

from __future__ import annotations

import numpy as np

from sim.world import World
from tests.engagements import drag, random_turns, task


def test_a_restored_world_flies_on_bit_for_bit() -> None:
    world, turns = World(task(), 40, seed=3), random_turns(120, 40)
    for turn in turns[:60]:
        world.step(turn)
    kept = world.state()
    first = [world.step(turn).observation for turn in turns[60:]]
    np.testing.assert_array_equal(world.restore(kept), world.observation)
    again = [world.step(turn).observation for turn in turns[60:]]
    np.testing.assert_array_equal(first, again)


def test_a_state_flies_the_same_in_another_lane_of_another_world() -> None:
    world = World(task(), 33, seed=3)
    for _ in range(50):
        world.step(drag(world.observation))
    lane = 29
    alone = World(task(), 1, seed=3)
    alone.restore({name: values[lane : lane + 1] for name, values in world.state().items()})
    for _ in range(30):
        turn = drag(world.observation)
        step, single = world.step(turn), alone.step(turn[lane])
        np.testing.assert_array_equal(step.observation[lane], single.observation[0])
        np.testing.assert_array_equal(step.reward_terms[lane], single.reward_terms[0])
