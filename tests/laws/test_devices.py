"""The same kernel flies on a GPU: the same ends, and states that differ by rounding alone."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp

from sim.device import start_warp
from sim.world import World
from tests.engagements import fly_lanes, random_turns, task

LANES = 256
STEPS = 200
TURNS = random_turns(STEPS, LANES, seed=2)


@pytest.fixture(scope="module")
def cuda() -> str:
    start_warp()
    if not wp.is_cuda_available():
        pytest.skip("no CUDA device")
    return "cuda:0"


@pytest.mark.gpu
def test_a_gpu_flies_the_same_engagements(cuda: str) -> None:
    here = fly_lanes(World(task(), LANES, seed=3), TURNS, steps=STEPS)
    there = fly_lanes(World(task(), LANES, seed=3, device=cuda), TURNS, steps=STEPS)
    same = here.outcome == there.outcome
    assert same.mean() > 0.98
    np.testing.assert_array_equal(here.observation[0, :, :2], there.observation[0, :, :2])
    # Where the evader stands after a minute of open-loop turns, to a metre.
    np.testing.assert_allclose(here.observation[50, :, :2], there.observation[50, :, :2], atol=1.0)


@pytest.mark.gpu
def test_a_gpu_repeats_itself_bit_for_bit(cuda: str) -> None:
    first, again = (fly_lanes(World(task(), LANES, seed=3, device=cuda), TURNS, steps=STEPS) for _ in range(2))
    np.testing.assert_array_equal(first.observation, again.observation)
    np.testing.assert_array_equal(first.terms, again.terms)


@pytest.mark.gpu
def test_the_order_of_lanes_does_not_matter_on_a_gpu_either(cuda: str) -> None:
    order = np.random.default_rng(1).permutation(LANES)
    plain = fly_lanes(World(task(), LANES, seed=3, device=cuda), TURNS, steps=STEPS)
    world = World(task(), LANES, seed=3, device=cuda)
    world.reset(episodes=order)
    shuffled = fly_lanes(world, TURNS[:, order], steps=STEPS)
    np.testing.assert_array_equal(plain.observation[:, order], shuffled.observation)
