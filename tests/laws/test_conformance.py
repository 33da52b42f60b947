"""The environments are what Gymnasium and Stable-Baselines3 expect, for every mask and through the installed name."""

from __future__ import annotations

import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from stable_baselines3.common.env_checker import check_env as check_env_sb3

from sim.environment import EvasionEnv, EvasionVectorEnv
from sim.world import World
from tests.engagements import MASKS, drag, fly_lanes, straight, task

# The paper's action is an angle in radians; both checkers would rather see [-1, 1].
RADIANS = "ignore:.*symmetric and normalized"
SOME = ["", "4", "3,4", "2,3,4", "1,2,3,4", "1,3"]
EVERY = [",".join(map(str, sorted(masked))) for masked in MASKS]


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("mask", SOME)
def test_gymnasium_accepts_it(mask: str) -> None:
    check_env(gymnasium.make("SubMas/Evasion-v0", mask=mask).unwrapped, skip_render_check=True)


@pytest.mark.filterwarnings(RADIANS)
@pytest.mark.parametrize("mask", SOME)
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


@pytest.mark.parametrize("masked", MASKS, ids=EVERY)
def test_no_number_is_ever_nan_or_infinite(masked: frozenset[int]) -> None:
    for act in (drag, straight):
        flights = fly_lanes(World(task(*masked), 16, seed=9), act)
        assert np.isfinite(flights.observation).all()
        assert np.isfinite(flights.terms).all()


def test_wild_steering_gives_no_nan() -> None:
    wild = np.random.default_rng(1).uniform(-np.pi / 2, np.pi / 2, (400, 64))
    flights = fly_lanes(World(task(), 64, seed=9), wild, steps=400)
    assert np.isfinite(flights.observation).all()
