"""The world's bookkeeping: lanes, episode numbers, resets, copies."""

from __future__ import annotations

import numpy as np
import pytest

from sim.start import initial_states
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, MASKS, changed, drag, fly_lanes, random_turns, straight, task


def test_a_new_world_is_ready_to_fly() -> None:
    world = World(task(), 3)
    assert world.observation.shape == (3, 15)
    assert (world.outcome == Outcome.FLYING).all()
    assert (world.fate == Fate.UNLAUNCHED).all()
    assert (world.killer == 0).all()
    assert (world.steps == 0).all()


def test_a_step_has_the_declared_shapes_and_kinds() -> None:
    step = World(task(2), 5).step(np.zeros(5))
    assert (step.observation.shape, step.observation.dtype) == ((5, 13), np.float32)
    assert (step.reward_terms.shape, step.reward_terms.dtype) == ((5, 6), np.float32)
    assert (step.reward.shape, step.reward.dtype) == ((5,), np.float32)
    assert (step.terminated.shape, step.terminated.dtype) == ((5,), np.bool_)
    assert (step.truncated.shape, step.truncated.dtype) == ((5,), np.bool_)


def test_lanes_start_with_the_first_episodes() -> None:
    expected = initial_states(DRILL, 9, np.arange(4))
    np.testing.assert_array_equal(World(task(), 4, seed=9).observation[:, :2], expected[:, :2])


def test_restarted_lanes_take_the_next_unused_episodes() -> None:
    world = World(task(), 3, seed=9)
    world.reset(lanes=[2, 0])
    world.reset(lanes=np.array([False, True, False]))
    expected = initial_states(DRILL, 9, np.array([4, 5, 3]))
    np.testing.assert_array_equal(world.observation[:, :2], expected[:, :2])


def test_an_episode_can_be_asked_for_by_number() -> None:
    world = World(task(), 2, seed=9)
    world.step([0.3, 0.3])
    observation = world.reset(lanes=[1], episodes=[77])
    np.testing.assert_array_equal(observation[1], World(task(), 78, seed=9).observation[77])


def test_asking_for_a_number_uses_none_up() -> None:
    world = World(task(), 1, seed=9)
    world.reset(episodes=[500])
    world.reset()
    np.testing.assert_array_equal(world.observation, World(task(), 2, seed=9).observation[1:])


def test_resetting_no_lane_changes_nothing() -> None:
    world = World(task(), 2)
    before = world.observation
    np.testing.assert_array_equal(world.reset(lanes=[]), before)
    np.testing.assert_array_equal(world.reset(lanes=np.zeros(2, dtype=bool)), before)


def test_restarting_one_lane_leaves_the_others_alone() -> None:
    turns = random_turns(60, 4, seed=2)
    with_restart, without = World(task(), 4, seed=1), World(task(), 4, seed=1)
    for k, turn in enumerate(turns):
        a, b = with_restart.step(turn), without.step(turn)
        np.testing.assert_array_equal(a.observation[[0, 2, 3]], b.observation[[0, 2, 3]])
        np.testing.assert_array_equal(a.reward_terms[[0, 2, 3]], b.reward_terms[[0, 2, 3]])
        if k == 20:
            with_restart.reset(lanes=[1])


def test_a_restarted_lane_remembers_nothing() -> None:
    # Flown to its end, with missiles in the air, and restarted with its own episode: the same flight again.
    world = World(task(), 6, seed=4)
    first = fly_lanes(world, drag)
    world.reset(episodes=np.arange(6))
    again = fly_lanes(world, drag)
    np.testing.assert_array_equal(first.observation, again.observation)
    np.testing.assert_array_equal(first.terms, again.terms)


def test_a_restarted_interceptor_need_not_wait() -> None:
    # The launch interval counts from a launch, and the last flight's launches are forgotten.
    world = World(task(scenario=changed(launch={"range_m": 100e3, "interval_s": 600.0})), 1)
    for _ in range(2):
        world.step([0.0])
        assert world.fate[0].tolist() == [Fate.FLYING, *[Fate.UNLAUNCHED] * 3]
        world.reset()


def test_actions_may_be_flat_or_columns() -> None:
    turns = random_turns(1, 3)[0]
    flat, column = World(task(), 3).step(turns), World(task(), 3).step(turns[:, None])
    np.testing.assert_array_equal(flat.observation, column.observation)


def test_actions_of_the_wrong_number_are_refused() -> None:
    with pytest.raises(ValueError, match="cannot reshape"):
        World(task(), 3).step(np.zeros(2))


def test_actions_beyond_a_quarter_turn_are_clipped() -> None:
    far, limit = World(task(), 2).step([9.0, -9.0]), World(task(), 2).step([np.pi / 2, -np.pi / 2])
    np.testing.assert_array_equal(far.observation, limit.observation)


def test_results_are_copies() -> None:
    world = World(task(), 2)
    held = world.step([0.1, 0.2])
    kept = held.observation.copy(), held.reward_terms.copy(), world.observation
    world.step([0.4, -0.4])
    np.testing.assert_array_equal(held.observation, kept[0])
    np.testing.assert_array_equal(held.reward_terms, kept[1])
    held.observation[:] = 0.0
    assert (world.observation != 0.0).any()


def test_no_column_of_the_observation_is_constant() -> None:
    flights = fly_lanes(World(task(), 8, seed=3), drag)
    assert (np.ptp(flights.observation.reshape(-1, 15), axis=0) > 0.0).all()


@pytest.mark.parametrize("masked", MASKS, ids=lambda masked: ",".join(map(str, sorted(masked))) or "none")
def test_masked_missiles_stay_on_the_rail(masked: frozenset[int]) -> None:
    flights = fly_lanes(World(task(*masked), 16, seed=2), straight)
    columns = [m - 1 for m in masked]
    assert (flights.fates[..., columns] == Fate.UNLAUNCHED).all()
    if len(masked) < 4:
        assert (flights.fates[-1].max(axis=1) > Fate.UNLAUNCHED).all()


def test_missiles_are_fired_in_ascending_order() -> None:
    fates = fly_lanes(World(task(2), 32, seed=2), drag).fates != Fate.UNLAUNCHED
    assert (fates[..., 0] >= fates[..., 2]).all()
    assert (fates[..., 2] >= fates[..., 3]).all()
    assert fates[-1, :, 3].any()


def test_scenarios_with_other_numbers_of_missiles_fly() -> None:
    scenario = changed(launch={"missiles": 6})
    step = World(task(scenario=scenario), 2).step([0.0, 0.0])
    assert step.observation.shape == (2, 19)
    assert step.reward_terms.shape == (2, 8)


def test_a_world_can_record_its_substeps() -> None:
    world = World(task(), 2)
    world.trace()
    start = world.snapshot(1)
    step = world.step([0.2, -0.2])
    rows = world.traced(1)
    assert start.shape == (1, 46)
    assert rows.shape == (20, 46)
    np.testing.assert_array_equal(rows[-1, :2], step.observation[1, :2])


def test_recording_changes_no_flight() -> None:
    silent, recorded = World(task(), 4, seed=6), World(task(), 4, seed=6)
    recorded.trace()
    a, b = fly_lanes(silent, drag), fly_lanes(recorded, drag)
    np.testing.assert_array_equal(a.observation, b.observation)
