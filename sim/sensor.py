"""The missile warning of the evader: what its observation makes of the truth when a scenario's `Sensor` is not perfect.

The numbers drawn depend on seed, episode, step and missile alone, so an observation may be asked for twice, and lanes
may be flown in any order. Position, heading, interceptor and exit are always known.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.geometry import wrap_to_pi
from sim.observation import BLOCK, OWN_NAMES, UNLAUNCHED
from sim.scenario import Sensor

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


def sense(
    sensor: Sensor, seed: int, episode: NDArray, step: NDArray, age_s: NDArray, truth: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Observation `[L, d]` as the sensor gives it: late and lost contacts show the default block, others are noisy.

    Args:
        sensor: noise, losses and delay.
        seed: seed of the world.
        episode: episode number of every lane `[L]`.
        step: decision steps flown `[L]`.
        age_s: time since the launch of the task's missiles `[L, m]` [s].
        truth: observation `[L, 7 + 2 m]`.
    """
    out = truth.copy()
    own = len(OWN_NAMES)
    blocks = out[:, own:].reshape(len(out), -1, BLOCK)
    draws = _uniform(seed, episode, step, blocks.shape[1])
    spread = np.sqrt(-2.0 * np.log(draws[..., 0]))  # Box-Muller: two normal numbers from two uniform ones
    noise = spread[..., None] * np.stack((np.cos(2 * np.pi * draws[..., 1]), np.sin(2 * np.pi * draws[..., 1])), -1)
    seen = blocks[..., 0] >= 0.0
    lost = seen & ((draws[..., 2] < sensor.drop_out) | (age_s < sensor.warning_delay_s))
    distance = np.maximum(blocks[..., 0] + sensor.range_noise_m * noise[..., 0], 0.0)
    azimuth = wrap_to_pi(blocks[..., 1] + sensor.azimuth_noise_rad * noise[..., 1])
    heard = np.stack((distance, azimuth), axis=-1)
    blocks[...] = np.where(lost[..., None], UNLAUNCHED, np.where(seen[..., None], heard, blocks))
    return out


def _uniform(seed: int, episode: NDArray, step: NDArray, missiles: int) -> NDArray[np.float64]:
    """Numbers `[L, m, 3]` in (0, 1): a hash of seed, episode, step, missile and channel (SplitMix64, Steele 2014)."""
    key = np.uint64(seed)
    for part in (episode, step):
        key = _mix(key + _GOLDEN * (part.astype(np.uint64) + np.uint64(1)))
    counter = np.arange(1, 3 * missiles + 1, dtype=np.uint64)
    bits = _mix(key[:, None] + _GOLDEN * counter) >> np.uint64(11)
    return ((bits.astype(np.float64) + 0.5) / 2.0**53).reshape(len(step), missiles, 3)


def _mix(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
