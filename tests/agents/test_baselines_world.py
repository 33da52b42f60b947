"""The adapter to Stable-Baselines3: the streams of a world stepped by hand, and ends that are what they say."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from agents.baselines_learner import Sac
from agents.baselines_world import TaskVecEnv
from agents.config import PROFILES
from agents.evasion import EVASION
from agents.task import GOAL_REACHED
from sim.task import task_for
from tests.agents.point_robot import MAX_STEPS, POINT_ROBOT, RobotTask

TERMINATED, TRUNCATED, BOTH, NEITHER = range(4)
LENGTHS = np.array([3, 4, 5, 10**6])
"""Steps of an episode in the lanes of a script: one ends by itself, one is cut, one is both, one goes on for ever."""


class Script:
    """A world that observes (lane, episode, step), pays its step number and ends as its lane says."""

    def __init__(self, lanes: int = 4) -> None:
        self.lanes = lanes
        self.episode, self.steps = np.full(lanes, -1), np.zeros(lanes, int)
        self.outcome, self.killer, self.fate = np.zeros(lanes, int), np.zeros(lanes, int), np.zeros((lanes, 0), int)

    def observation(self) -> np.ndarray:
        return np.column_stack((np.arange(self.lanes), self.episode, self.steps)).astype(np.float32)

    def reset(self, lanes: Any = None, episodes: Any = None) -> np.ndarray:
        chosen = np.arange(self.lanes) if lanes is None else lanes
        self.episode[chosen] += 1
        self.steps[chosen] = self.outcome[chosen] = 0
        return self.observation()

    def step(self, _actions: Any, /) -> Any:
        self.steps += 1
        over = self.steps == LENGTHS[: self.lanes]
        self.outcome[over] = GOAL_REACHED
        kind = np.arange(self.lanes)
        ends = over & (kind != TRUNCATED), over & ((kind == TRUNCATED) | (kind == BOTH))
        return SimpleNamespace(
            observation=self.observation(), reward=self.steps.astype(np.float32), terminated=ends[0], truncated=ends[1]
        )


class ScriptDomain:
    """As much of a domain as the adapter asks for; features are the observation itself."""

    action_limit = 0.5

    def world(self, task: Any, lanes: int, seed: int) -> Script:
        return Script(lanes)

    def features(self, layout: Any) -> Any:
        return SimpleNamespace(size=3, encode=lambda observation: observation.copy())


def scripted(reward_scale: float = 1.0) -> TaskVecEnv:
    task: Any = SimpleNamespace(layout=None)
    domain: Any = ScriptDomain()
    return TaskVecEnv(domain, task, 4, 0, reward_scale)


def test_the_end_of_an_episode_is_told_as_it_was() -> None:
    env = scripted()
    env.reset()
    told = {}
    for _ in range(5):
        features, _, over, infos = env.step(np.zeros((4, 1), np.float32))
        for lane in np.flatnonzero(over):
            told.setdefault(int(lane), (infos[lane], features[lane].copy()))
        assert [bool(info) for info in infos] == over.tolist()
    assert sorted(told) == [TERMINATED, TRUNCATED, BOTH]
    # Cut off means cut off and not ended: where both are true the end counts.
    assert {lane: info["TimeLimit.truncated"] for lane, (info, _) in told.items()} == {
        TERMINATED: False,
        TRUNCATED: True,
        BOTH: False,
    }
    for lane, (info, after) in told.items():
        assert info["terminal_observation"].tolist() == [lane, 0, LENGTHS[lane]]
        assert after.tolist() == [lane, 1, 0]


def test_only_the_learner_sees_the_reward_scale() -> None:
    env = scripted(0.01)
    env.reset()
    rewards = [env.step(np.zeros((4, 1), np.float32))[1] for _ in range(4)]
    np.testing.assert_allclose(rewards[1], 0.02)
    assert [(episode.episode_return, episode.steps) for episode in env.finished] == [(6.0, 3), (10.0, 4)]
    assert rewards[0].dtype == np.float32 and all(episode.success for episode in env.finished)


def test_the_librarys_replay_holds_whole_steps_and_bootstraps_through_the_limit() -> None:
    """From observation to true next observation, never into another episode; done where an episode ended for good."""
    hyper = PROFILES["smoke"]
    learner = Sac(scripted(), hyper, seed=0, literal=False)
    learner.learn(4 * 40)
    replay = learner.model.replay_buffer
    assert replay is not None and replay.pos == 40
    before, after = replay.observations[:40], replay.next_observations[:40]
    np.testing.assert_array_equal(after - before, np.broadcast_to([0.0, 0.0, 1.0], before.shape))
    ended = (replay.dones * (1 - replay.timeouts))[:40].astype(bool)
    kind, step = after[..., 0].astype(int), after[..., 2]
    np.testing.assert_array_equal(ended, (step == LENGTHS[kind]) & (kind != TRUNCATED))
    assert ended.any() and (replay.dones[:40].astype(bool) & ~ended).any()


@pytest.mark.parametrize(
    ("domain", "task"), [(POINT_ROBOT, RobotTask()), (EVASION, task_for())], ids=["robot", "evasion"]
)
def test_a_stream_is_that_of_a_world_stepped_by_hand(domain: Any, task: Any) -> None:
    lanes = 6
    env, twin = TaskVecEnv(domain, task, lanes, 7, 1.0), domain.world(task, lanes, 7)
    features = domain.features(task.layout)
    np.testing.assert_array_equal(env.reset(), features.encode(twin.reset()))
    generator, ends = np.random.default_rng(0), 0
    for _ in range(150):
        actions = generator.uniform(-1.0, 1.0, (lanes, 1)).astype(np.float32) * env.action_limit
        seen, reward, over, infos = env.step(actions)
        step = twin.step(actions)
        true, cut = features.encode(step.observation), step.truncated
        np.testing.assert_array_equal(over, step.terminated | cut)
        np.testing.assert_array_equal(reward, step.reward)
        for lane in np.flatnonzero(over):
            np.testing.assert_array_equal(infos[lane]["terminal_observation"], true[lane])
            assert infos[lane]["TimeLimit.truncated"] == cut[lane]
        after = features.encode(twin.reset(lanes=np.flatnonzero(over))) if over.any() else true
        np.testing.assert_array_equal(seen, after)
        ends += over.sum()
    assert ends and len(env.finished) == min(ends, 100)


def test_circling_until_the_limit_is_cut_off_and_nothing_else() -> None:
    env = TaskVecEnv(POINT_ROBOT, RobotTask(frozenset({1, 2})), 20, 0, 1.0)
    env.reset()
    cut = []
    for step in range(1, MAX_STEPS + 1):
        _, _, over, infos = env.step(np.full((20, 1), env.action_limit))
        # Some drift out of the plane while they circle, which is an end.
        assert all(infos[lane]["TimeLimit.truncated"] == (step == MAX_STEPS) for lane in np.flatnonzero(over))
        cut.append(over.sum())
    assert cut[-1] > 0 and sum(cut) > cut[-1]


def test_lanes_are_as_bare_as_the_library_may_expect() -> None:
    env = scripted()
    assert env.render_mode is None and env.env_is_wrapped(object) == [False] * 4
    assert env.get_attr("action_limit", [0, 2]) == [np.float32(0.5)] * 2
    with pytest.raises(NotImplementedError, match="colour"):
        env.set_attr("colour", 1)
    with pytest.raises(NotImplementedError, match="paint"):
        env.env_method("paint")
    env.close()
