"""Law: the environments are what Gymnasium and Stable-Baselines3 expect, for every mask and by their installed name."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from sim.environment import EvasionEnv, EvasionVectorEnv
from tests.engagements import MASKS

# The paper's action is an angle in radians; both checkers would rather see [-1, 1].
RADIANS = "ignore:.*symmetric and normalized"
EVERY = [",".join(map(str, sorted(masked))) for masked in MASKS]


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("mask", EVERY)
def test_gymnasium_accepts_it(mask: str) -> None:
    check_env(gymnasium.make("SubMas/Evasion-v0", mask=mask).unwrapped, skip_render_check=True)


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("mask", EVERY)
def test_stable_baselines3_accepts_it(mask: str) -> None:
    check_env_sb3(EvasionEnv(mask=mask))


@pytest.mark.parametrize(("imported", "prefix"), [("gymnasium", "sim:"), ("gymnasium, sim", "")])
def test_made_by_name_from_the_installed_package(imported: str, prefix: str, tmp_path: Path) -> None:
    # As a user does it, far from the checkout.
    code = (
        f"import {imported}\n"
        f"env = gymnasium.make('{prefix}SubMas/Evasion-v0', mask='3,4')\n"
        "print(env.reset(seed=1)[0].shape, env.action_space.shape)\n"
        f"batch = gymnasium.make_vec('{prefix}SubMas/Evasion-v0', num_envs=3, mask='4')\n"
        "print(batch.reset(seed=1)[0].shape, type(batch).__name__)"
    )
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, timeout=120)
    assert done.stderr == ""
    assert done.stdout.splitlines() == ["(11,) (1,)", "(3, 13) EvasionVectorEnv"]


def test_make_vec_gives_the_batch() -> None:
    batch = gymnasium.make_vec("SubMas/Evasion-v0", num_envs=5, mask="1,2")
    assert isinstance(batch.unwrapped, EvasionVectorEnv)
    assert batch.observation_space.shape == (5, 11)


def test_the_batch_records_episode_statistics_like_any_other() -> None:
    batch = gymnasium.wrappers.vector.RecordEpisodeStatistics(EvasionVectorEnv(2, mask="1,2,3,4"))
    batch.reset(seed=4)
    ended = None
    for _ in range(1200):
        *_, info = batch.step(np.full((2, 1), 0.5, np.float32))
        if "episode" in info:
            ended = info["episode"]
            break
    assert ended is not None
    assert ended["l"].max() > 100


@pytest.mark.parametrize("mask", EVERY)
def test_all_sixteen_masks_fly_within_their_spaces(mask: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = EvasionEnv(mask=mask)
        observation, _ = env.reset(seed=7)
        assert env.observation_space.contains(observation)
        env.action_space.seed(7)
        for _ in range(50):
            observation, reward, terminated, truncated, _ = env.step(env.action_space.sample())
            assert env.observation_space.contains(observation)
            assert np.isfinite(reward)
            if terminated or truncated:
                break


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("mask", EVERY)
def test_the_batch_of_a_mask_is_its_single_engagements(mask: str) -> None:
    """Same spaces, observations, rewards and ends as the environment for one, restarts included."""
    single, batch = EvasionEnv(mask=mask), EvasionVectorEnv(1, mask=mask)
    assert batch.single_observation_space == single.observation_space
    assert batch.single_action_space == single.action_space
    seen, _ = batch.reset(seed=5)
    np.testing.assert_array_equal(seen[0], single.reset(seed=5)[0])
    batch.action_space.seed(5)
    for _ in range(40):
        action = batch.action_space.sample()
        seen, reward, terminated, truncated, info = batch.step(action)
        expected, earned, ended, cut, _ = single.step(action[0])
        last = info["final_obs"][0] if ended or cut else seen[0]
        np.testing.assert_array_equal(last, expected)
        assert (reward[0], terminated[0], truncated[0]) == (earned, ended, cut)
        assert batch.observation_space.contains(seen)
        if ended or cut:
            single.reset()


class Boundless(EvasionEnv):
    """Forgets the unit of its positions."""

    def step(self, action: NDArray) -> tuple[NDArray, float, bool, bool, dict[str, Any]]:
        observation, *rest = super().step(action)
        return observation * 1000.0, *rest


class Unseeded(EvasionEnv):
    """Starts anywhere, whatever the seed."""

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray, dict[str, Any]]:
        return super().reset(seed=int(np.random.default_rng().integers(2**31)), options=options)


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("broken", [Boundless, Unseeded])
def test_the_checkers_refuse_what_does_not_conform(broken: type[EvasionEnv]) -> None:
    # Gymnasium asserts some things and warns of others; here a warning is an error.
    with pytest.raises((AssertionError, UserWarning)):
        check_env(broken(), skip_render_check=True)


@pytest.mark.filterwarnings(RADIANS)
def test_the_other_checker_refuses_it_too() -> None:
    with pytest.raises(AssertionError):
        check_env_sb3(Boundless())
