"""The missile warning: noise, lost contacts and delay, as seen by a world, and off until a scenario says otherwise."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.observation import UNLAUNCHED
from sim.reference import ReferenceWorld
from sim.scenario import Sensor
from sim.sensor import sense
from sim.world import Fate, World
from tests.engagements import changed, circle, task, wrapped

LANES = 400
DEFAULT = np.array(UNLAUNCHED, dtype=np.float32)


def sensed(sensor: Sensor, seed: int = 0, step: int = 5, age_s: float = 30.0) -> NDArray:
    """Blocks `[L, 2, 2]` of lanes in which missile 1 is at 20 km, 2 rad, and missile 2 does not fly."""
    truth = np.zeros((LANES, 11), dtype=np.float32)
    truth[:, 7:] = [20e3, 2.0, *UNLAUNCHED]
    lanes = np.arange(LANES)
    out = sense(sensor, seed, lanes, np.full(LANES, step), np.full((LANES, 2), age_s), truth)
    np.testing.assert_array_equal(out[:, :7], truth[:, :7])
    return out[:, 7:].reshape(LANES, 2, 2)


def flown(sensor: dict[str, float], lanes: int = 8, seconds: int = 20) -> World:
    """A world in which missiles fly."""
    world = World(task(scenario=changed(sensor=sensor, launch={"range_m": 60e3})), lanes, seed=2)
    for _ in range(seconds):
        world.step(circle(world.observation))
    assert (world.fate == Fate.FLYING).any()
    return world


def test_noise_is_normal_with_the_given_spread_and_unbiased() -> None:
    blocks = sensed(Sensor(range_noise_m=300.0, azimuth_noise_rad=0.05))
    for error, spread in ((blocks[:, 0, 0] - 20e3, 300.0), (blocks[:, 0, 1] - 2.0, 0.05)):
        # Five standard errors of a mean and of a spread over 400 draws.
        assert abs(error.mean()) < 5 * spread / 20
        assert error.std() == pytest.approx(spread, rel=5 / np.sqrt(800))
        assert 0.6 < (abs(error) < spread).mean() < 0.76
    np.testing.assert_array_equal(blocks[:, 1], np.broadcast_to(DEFAULT, (LANES, 2)))


def test_lost_contacts_show_the_default_block_as_often_as_they_should() -> None:
    lost = (sensed(Sensor(drop_out=0.3))[:, 0] == DEFAULT).all(axis=1)
    assert lost.mean() == pytest.approx(0.3, abs=5 * np.sqrt(0.3 * 0.7 / LANES))
    assert (sensed(Sensor(drop_out=1.0))[:, 0] == DEFAULT).all()


def test_a_missile_is_not_seen_before_the_warning_is_due() -> None:
    late = Sensor(warning_delay_s=4.0)
    assert (sensed(late, age_s=3.95)[:, 0] == DEFAULT).all()
    np.testing.assert_allclose(sensed(late, age_s=4.0)[:, 0], np.broadcast_to([20e3, 2.0], (LANES, 2)))


def test_draws_belong_to_seed_episode_and_step_and_to_nothing_else() -> None:
    noisy = Sensor(range_noise_m=300.0)
    first = sensed(noisy)
    np.testing.assert_array_equal(first, sensed(noisy))
    for other in (sensed(noisy, seed=1), sensed(noisy, step=6)):
        assert (first[:, 0, 0] != other[:, 0, 0]).all()
    assert len(np.unique(first[:, 0, 0])) == LANES


def test_angles_stay_in_their_interval_and_ranges_positive() -> None:
    blocks = sensed(Sensor(range_noise_m=10e3, azimuth_noise_rad=1.0))
    assert (blocks[:, 0, 0] >= 0.0).all()
    assert (abs(blocks[:, 0, 1]) <= np.float32(np.pi)).all()


def test_what_happens_does_not_depend_on_what_is_seen() -> None:
    clear, blind = flown({}), flown({"drop_out": 1.0})
    np.testing.assert_array_equal(clear.fate, blind.fate)
    np.testing.assert_array_equal(clear.missiles["position"], blind.missiles["position"])
    blocks = blind.observation[:, 7:].reshape(8, 4, 2)
    np.testing.assert_array_equal(blocks, np.broadcast_to(DEFAULT, blocks.shape))


def test_an_observation_may_be_asked_for_twice() -> None:
    world = flown({"range_noise_m": 500.0, "drop_out": 0.2})
    np.testing.assert_array_equal(world.observation, world.observation)


def test_kernel_and_reference_have_the_same_sensors() -> None:
    sensor = {"range_noise_m": 500.0, "azimuth_noise_rad": 0.1, "drop_out": 0.2, "warning_delay_s": 3.0}
    scenario = changed(sensor=sensor, launch={"range_m": 60e3})
    kernel, reference = (kind(task(scenario=scenario), 16, seed=4) for kind in (World, ReferenceWorld))
    for _ in range(25):
        ours, theirs = (world.step(np.full(16, 0.3)).observation.astype(float) for world in (kernel, reference))
    assert (ours[:, 7] > 0.0).any()
    assert np.abs(ours[:, 7::2] - theirs[:, 7::2]).max() < 1.0
    assert np.abs(wrapped(ours[:, 8::2] - theirs[:, 8::2])).max() < 1e-3
