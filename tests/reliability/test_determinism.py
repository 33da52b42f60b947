"""Law: the same seed gives the same bits, whatever flies beside a lane, in whatever order and on how many threads."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from sim.trajectory import fly
from sim.world import Step, World
from tests.engagements import Flights, changed, drag, fly_lanes, random_turns, task
from tests.laws.records import hard_turns

LANES = 40
TURNS = random_turns(200, LANES, seed=11)


def together(episodes: NDArray, turns: NDArray, world: type[World] = World, threads: int = 1) -> Flights:
    """Episodes of seed 13 flown side by side with given turns `[K, L]`."""
    lanes = world(task(), len(episodes), seed=13, threads=threads)
    lanes.reset(episodes=episodes)
    return fly_lanes(lanes, turns, steps=len(turns))


def equal(
    a: Flights, b: Flights, lanes_a: NDArray | slice = slice(None), lanes_b: NDArray | slice = slice(None)
) -> bool:
    """Whether lanes have the same observations, rewards, ends and fates, bit for bit."""
    along = ("observation", "terms", "terminated", "truncated", "fates")
    same = [np.array_equal(getattr(a, name)[:, lanes_a], getattr(b, name)[:, lanes_b]) for name in along]
    return all(same) and all(
        np.array_equal(getattr(a, name)[lanes_a], getattr(b, name)[lanes_b]) for name in ("outcome", "killer", "steps")
    )


@pytest.fixture(scope="module")
def batch() -> Flights:
    return together(np.arange(LANES), TURNS)


def test_the_same_seed_flies_the_same_bits(batch: Flights) -> None:
    assert equal(batch, together(np.arange(LANES), TURNS))


def test_another_seed_flies_something_else(batch: Flights) -> None:
    world = World(task(), LANES, seed=14)
    assert (world.observation[:, :2] != batch.observation[0, :, :2]).all()


def test_the_order_of_lanes_does_not_matter(batch: Flights) -> None:
    order = np.random.default_rng(5).permutation(LANES)
    assert equal(together(order, TURNS[:, order]), batch, slice(None), order)


@pytest.mark.parametrize("lanes", [1, 2, 15, 16, 17, 33])
def test_the_number_of_lanes_does_not_matter(batch: Flights, lanes: int) -> None:
    assert equal(together(np.arange(lanes), TURNS[:, :lanes]), batch, slice(None), slice(0, lanes))


def test_a_batch_is_its_lanes_flown_one_by_one(batch: Flights) -> None:
    for lane in range(LANES):
        assert equal(together(np.array([lane]), TURNS[:, [lane]]), batch, slice(None), slice(lane, lane + 1))


@pytest.mark.parametrize("threads", [2, 3, 8])
def test_the_number_of_threads_does_not_matter(threads: int) -> None:
    episodes, turns = np.arange(150), hard_turns(60, 150, seed=4)
    assert equal(together(episodes, turns), together(episodes, turns, threads=threads))


def test_twins_stay_twins() -> None:
    flights = together(np.array([3] * 20), np.repeat(TURNS[:, [3]], 20, axis=1))
    for lane in range(1, 20):
        assert equal(flights, flights, slice(0, 1), slice(lane, lane + 1))


def test_a_lane_that_is_reset_while_others_fly_disturbs_none(batch: Flights) -> None:
    world = World(task(), LANES, seed=13)
    seen = []
    for k, turns in enumerate(TURNS):
        if k % 7 == 3:
            world.reset(lanes=[5, 21])
        seen.append(world.step(turns).observation)
    others = np.setdiff1d(np.arange(LANES), [5, 21])
    np.testing.assert_array_equal(np.stack(seen)[:, others], batch.observation[1:, others])


def test_an_observation_stays_what_it_was() -> None:
    world = World(task(), LANES, seed=13)
    kept = [world.observation, *(world.step(turns).observation for turns in TURNS[:5])]
    copies = [observation.copy() for observation in kept]
    world.step(TURNS[5])
    world.reset()
    for observation, copy in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(observation, copy)


class Neighbourly(World):
    """Steering in one lane is felt, a little, in the next."""

    def step(self, actions: ArrayLike) -> Step:
        turns = np.asarray(actions, dtype=np.float32)
        return super().step(turns + 1e-6 * np.roll(turns, 1))


class Forgetful(World):
    """Every world flies a little differently from the one before."""

    made = 0

    def step(self, actions: ArrayLike) -> Step:
        Forgetful.made += 1
        return super().step(np.asarray(actions) + 1e-7 * Forgetful.made)


def test_lanes_that_feel_one_another_would_be_noticed() -> None:
    order = np.random.default_rng(5).permutation(LANES)
    plain = together(np.arange(LANES), TURNS, Neighbourly)
    assert not equal(together(order, TURNS[:, order], Neighbourly), plain, slice(None), order)
    assert not equal(together(np.arange(17), TURNS[:, :17], Neighbourly), plain, slice(None), slice(0, 17))


def test_a_world_that_remembers_would_be_noticed() -> None:
    first, again = (together(np.arange(LANES), TURNS, Forgetful) for _ in range(2))
    assert not equal(first, again)


def test_one_bit_of_one_lane_would_be_noticed(batch: Flights) -> None:
    other = together(np.arange(LANES), TURNS)
    assert equal(batch, other)
    other.observation[-1, 7, 0] = np.nextafter(other.observation[-1, 7, 0], np.float32(np.inf))
    assert not equal(batch, other)


def test_a_recorded_flight_is_the_same_every_time() -> None:
    first, again = (fly(task(), drag, "drag", seed=2, episode=3) for _ in range(2))
    np.testing.assert_array_equal(first.evader.position_m, again.evader.position_m)
    np.testing.assert_array_equal(first.missiles[0].range_m, again.missiles[0].range_m)
    assert [str(event) for event in first.events] == [str(event) for event in again.events]


def test_a_recorded_flight_is_the_lane_of_the_same_number() -> None:
    lanes = World(task(scenario=changed(rules={"max_steps": 60})), 20, seed=2)
    flights = fly_lanes(lanes, drag)
    for episode in (0, 7, 19):
        recorded = fly(lanes.task, drag, "drag", seed=2, episode=episode)
        seen = flights.observation[: len(recorded.observation), episode]
        np.testing.assert_array_equal(recorded.observation.astype(np.float32), seen)


def test_another_process_flies_the_same_bits(batch: Flights) -> None:
    # Nothing may depend on what a process did before: hash seeds, caches, the order of imports.
    code = (
        "import hashlib, numpy as np\n"
        "from tests.reliability.test_determinism import LANES, TURNS, together\n"
        "print(hashlib.sha256(together(np.arange(LANES), TURNS).observation.tobytes()).hexdigest())"
    )
    root = Path(__file__).parents[2]
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=root, timeout=120)
    assert done.stdout.strip() == hashlib.sha256(batch.observation.tobytes()).hexdigest()
