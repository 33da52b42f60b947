"""The Gymnasium environments as a user meets them."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from sim import environment
from sim.environment import EvasionEnv, EvasionVectorEnv, make_task, observation_space
from sim.errors import MaskError, ScenarioError
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import World
from tests.engagements import MASKS, changed, drag, fly_lanes, random_turns, task


@pytest.fixture(autouse=True)
def drill(monkeypatch: pytest.MonkeyPatch) -> None:
    """Environments made without a scenario fly a drill that is over after at most 60 steps."""
    quick = changed(rules={"max_steps": 60})
    monkeypatch.setattr(environment, "load_scenario", lambda name: quick if name == "default" else load_scenario(name))


def test_a_mask_may_be_text_or_numbers() -> None:
    assert make_task(mask="3,4") == make_task(mask=(3, 4))
    assert make_task(mask=()) == make_task(mask="")


def test_mistakes_are_those_of_the_simulator() -> None:
    with pytest.raises(MaskError, match="legal are 1 to 4"):
        EvasionEnv(mask="5")
    with pytest.raises(ScenarioError, match="no scenario 'nowhere'"):
        EvasionEnv(scenario="nowhere")


def test_an_episode_is_the_worlds() -> None:
    env = EvasionEnv()
    world = World(env.task, 1, seed=12)
    observation, info = env.reset(seed=12)
    np.testing.assert_array_equal(observation, world.observation[0])
    assert info == {}
    for turn in random_turns(60, 1, seed=1):
        observation, reward, terminated, truncated, info = env.step(turn)
        step = world.step(turn)
        np.testing.assert_array_equal(observation, step.observation[0])
        assert reward == pytest.approx(float(step.reward[0]), abs=1e-4)
        assert (terminated, truncated) == (step.terminated[0], step.truncated[0])
        assert isinstance(terminated, bool)
        if terminated or truncated:
            break
    assert set(info) == {"outcome", "missiles_evaded"}


def test_the_last_step_says_how_it_ended() -> None:
    env = EvasionEnv(mask="1,2,3,4")
    env.reset(seed=1)
    infos = [env.step(np.array([0.5], np.float32)) for _ in range(60)]
    *_, terminated, truncated, info = infos[-1]
    assert (terminated, truncated) == (False, True)
    assert info == {"outcome": "timeout", "missiles_evaded": 0}
    assert all(step[-1] == {} for step in infos[:-1])


def test_stepping_before_the_first_reset_is_refused() -> None:
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset before step"):
        EvasionEnv().step(np.zeros(1, np.float32))


def test_reset_without_a_seed_starts_another_episode() -> None:
    env = EvasionEnv()
    first, _ = env.reset(seed=5)
    second, _ = env.reset()
    again, _ = env.reset(seed=5)
    np.testing.assert_array_equal(first, again)
    assert (first != second).any()


def test_two_environments_without_seed_differ() -> None:
    assert (EvasionEnv().reset()[0] != EvasionEnv().reset()[0]).any()


@pytest.mark.parametrize("masked", MASKS, ids=str)
def test_every_observation_lies_in_its_space(masked: frozenset[int]) -> None:
    space = observation_space(task(*masked))
    flights = fly_lanes(World(task(*masked), 16, seed=3), drag)
    assert space.shape == (7 + 2 * (4 - len(masked)),)
    assert all(space.contains(row) for row in flights.observation.reshape(-1, space.shape[0]))


def test_the_default_block_lies_in_the_space() -> None:
    low = observation_space(task(2, 3, 4)).low
    np.testing.assert_array_equal(low[7:], np.array([-1.0, -np.pi], np.float32))


class TestVector:
    """Batches restart in the same step."""

    def test_it_declares_its_autoreset_mode(self) -> None:
        assert EvasionVectorEnv(2).metadata["autoreset_mode"] is AutoresetMode.SAME_STEP

    def test_its_lanes_are_single_environments_with_another_first_episode(self) -> None:
        vector, world = EvasionVectorEnv(3, mask="4"), World(Task(make_task().scenario, frozenset({4})), 3, seed=8)
        observation, _ = vector.reset(seed=8)
        np.testing.assert_array_equal(observation, world.observation)
        for turn in random_turns(20, 3, seed=4):
            got, expected = vector.step(turn[:, None]), world.step(turn)
            np.testing.assert_array_equal(got[0], expected.observation)
            np.testing.assert_allclose(got[1], expected.reward, atol=1e-4)

    def test_a_lane_that_ends_shows_its_last_observation_apart_and_the_next_first(self) -> None:
        vector, world = EvasionVectorEnv(4), World(make_task(), 4, seed=2)
        vector.reset(seed=2)
        restarts, fresh = 0, 4
        for turn in random_turns(150, 4, seed=5):
            observation, _, terminated, truncated, info = vector.step(turn[:, None])
            step = world.step(turn)
            over = terminated | truncated
            np.testing.assert_array_equal(over, step.terminated | step.truncated)
            if not over.any():
                assert info == {}
                continue
            np.testing.assert_array_equal(info["_final_obs"], over)
            for lane in range(4):
                expected = step.observation[lane] if over[lane] else None
                np.testing.assert_array_equal(info["final_obs"][lane], expected)
            first = world.reset(over)
            np.testing.assert_array_equal(observation, first)
            started = World(make_task(), fresh + int(over.sum()), seed=2).observation[fresh:]
            np.testing.assert_array_equal(observation[over], started)
            restarts, fresh = restarts + int(over.sum()), fresh + int(over.sum())
        assert restarts >= 8

    def test_outcomes_are_told(self) -> None:
        vector = EvasionVectorEnv(2, mask="1,2,3,4")
        vector.reset(seed=2)
        infos = [vector.step(np.full((2, 1), 0.5, np.float32))[-1] for _ in range(60)]
        assert infos[-1]["final_info"]["outcome"].tolist() == ["timeout", "timeout"]
        assert infos[-1]["final_info"]["missiles_evaded"].tolist() == [0, 0]

    def test_infos_have_the_form_of_gymnasiums_own_batches(self) -> None:
        own = gymnasium.vector.SyncVectorEnv([lambda: EvasionEnv(mask="2,3,4")] * 2, autoreset_mode="SameStep")
        ours = EvasionVectorEnv(2, mask="2,3,4")
        shapes = []
        for vector in (own, ours):
            vector.reset(seed=2)
            infos = [vector.step(np.full((2, 1), 0.5, np.float32))[-1] for _ in range(60)]
            flat = {**infos[-1], **infos[-1]["final_info"]}
            shapes.append({key: (type(value), getattr(value, "dtype", None)) for key, value in flat.items()})
        assert shapes[0] == shapes[1]

    def test_stepping_before_the_first_reset_is_refused(self) -> None:
        with pytest.raises(gymnasium.error.ResetNeeded, match="call reset before step"):
            EvasionVectorEnv(2).step(np.zeros((2, 1), np.float32))

    def test_reset_with_a_seed_starts_over_and_without_goes_on(self) -> None:
        vector = EvasionVectorEnv(2)
        first, _ = vector.reset(seed=3)
        other, _ = vector.reset()
        again, _ = vector.reset(seed=3)
        np.testing.assert_array_equal(first, again)
        assert (first != other).any(axis=1).all()

    def test_two_batches_without_seed_differ(self) -> None:
        assert (EvasionVectorEnv(2).reset()[0] != EvasionVectorEnv(2).reset()[0]).any()
