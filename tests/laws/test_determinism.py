"""The same seed gives the same bits, whatever flies beside a lane and however often it is asked."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.trajectory import fly
from sim.world import World
from tests.engagements import Flights, drag, fly_lanes, random_turns, task

LANES = 24
TURNS = random_turns(200, LANES, seed=11)


def together(episodes: np.ndarray, turns: np.ndarray, masked: tuple[int, ...] = ()) -> Flights:
    """Episodes of seed 13 flown side by side with given turns `[K, L]`."""
    world = World(task(*masked), len(episodes), seed=13)
    world.reset(episodes=episodes)
    return fly_lanes(world, turns, steps=len(turns))


def same(a: Flights, b: Flights, lanes_a: np.ndarray | slice, lanes_b: np.ndarray | slice) -> None:
    """Bit for bit the same observations, rewards, ends and fates."""
    np.testing.assert_array_equal(a.observation[:, lanes_a], b.observation[:, lanes_b])
    np.testing.assert_array_equal(a.terms[:, lanes_a], b.terms[:, lanes_b])
    np.testing.assert_array_equal(a.terminated[:, lanes_a], b.terminated[:, lanes_b])
    np.testing.assert_array_equal(a.fates[:, lanes_a], b.fates[:, lanes_b])
    np.testing.assert_array_equal(a.steps[lanes_a], b.steps[lanes_b])


@pytest.fixture(scope="module")
def batch() -> Flights:
    return together(np.arange(LANES), TURNS)


def test_the_same_seed_flies_the_same_bits(batch: Flights) -> None:
    same(batch, together(np.arange(LANES), TURNS), slice(None), slice(None))


def test_another_seed_flies_something_else(batch: Flights) -> None:
    world = World(task(), LANES, seed=14)
    assert (world.observation[:, :2] != batch.observation[0, :, :2]).all()


def test_the_order_of_lanes_does_not_matter(batch: Flights) -> None:
    order = np.random.default_rng(5).permutation(LANES)
    same(together(order, TURNS[:, order]), batch, slice(None), order)


@pytest.mark.parametrize("lanes", [1, 2, 7, 16])
def test_the_number_of_lanes_does_not_matter(batch: Flights, lanes: int) -> None:
    same(together(np.arange(lanes), TURNS[:, :lanes]), batch, slice(None), slice(0, lanes))


def test_a_batch_is_its_lanes_flown_one_by_one(batch: Flights) -> None:
    for lane in range(LANES):
        same(together(np.array([lane]), TURNS[:, [lane]]), batch, slice(None), slice(lane, lane + 1))


def test_twins_stay_twins() -> None:
    flights = together(np.array([3, 3, 3]), np.repeat(TURNS[:, [3]], 3, axis=1))
    same(flights, flights, slice(0, 1), slice(1, 2))
    same(flights, flights, slice(0, 1), slice(2, 3))


def test_a_recorded_flight_is_the_same_every_time() -> None:
    first, again = (fly(task(), drag, "drag", seed=2, episode=3) for _ in range(2))
    np.testing.assert_array_equal(first.evader.position_m, again.evader.position_m)
    np.testing.assert_array_equal(first.missiles[0].range_m, again.missiles[0].range_m)
    assert [str(event) for event in first.events] == [str(event) for event in again.events]


def test_another_process_flies_the_same_bits(batch: Flights) -> None:
    # Nothing may depend on what a process did before: hash seeds, caches, the order of imports.
    code = (
        "import hashlib, numpy as np\n"
        "from tests.laws.test_determinism import LANES, TURNS, together\n"
        "print(hashlib.sha256(together(np.arange(LANES), TURNS).observation.tobytes()).hexdigest())"
    )
    root = Path(__file__).parents[2]
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root, timeout=120)
    assert done.stdout.strip() == hashlib.sha256(batch.observation.tobytes()).hexdigest()
