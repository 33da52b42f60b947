"""Initial states rho (section 2.3): a function of seed and episode number alone, the same for every mask (Eq. 7)."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from sim.scenario import Scenario


def initial_states(scenario: Scenario, seed: int, episodes: NDArray[np.integer]) -> NDArray[np.float32]:
    """Initial states `[n, 10 + 6 M]` of numbered episodes; no mask is asked for, so every task has the same, Eq. (7).

    Columns are x, y, altitude [m], heading [rad] and speed [m/s] of the evader, the same of the interceptor, then for
    shots 1..M in the order in which they are fired the factors on launch range, and in blocks of M those on launch
    interval, thrust, drag, navigation constant and lag (all 1 without `Variation`).
    """
    return np.stack([_initial_state(scenario, seed, int(episode)) for episode in episodes]).astype(np.float32)


def _initial_state(scenario: Scenario, seed: int, episode: int) -> NDArray[np.float64]:
    # A counter-based generator keyed by (seed, episode): no episode depends on how many were drawn before it.
    draws = np.random.Generator(np.random.Philox(key=[seed, episode]))
    start, launch, variation = scenario.start, scenario.launch, scenario.variation
    unit = draws.uniform(-1.0, 1.0, 10 + launch.missiles)
    spreads = (start.y_spread_m, start.altitude_spread_m, start.heading_spread_rad, start.speed_spread_m_s)
    evader_x = _between(start.evader_x_low_m, start.evader_x_high_m, unit[0])
    interceptor_x = _between(start.interceptor_x_low_m, start.interceptor_x_high_m, unit[5])
    evader = (0.0, start.altitude_m, 0.0, start.evader_speed_m_s) + unit[1:5] * spreads
    interceptor = (0.0, start.altitude_m, np.pi, start.interceptor_speed_m_s) + unit[6:10] * spreads
    reaches = 1.0 + launch.spread * unit[10:]
    # Drawn last, so that switching a variation on leaves everything before it as it was.
    others = np.ravel([1.0 + spread * draws.uniform(-1.0, 1.0, launch.missiles) for spread in astuple(variation)])
    return np.concatenate([[evader_x], evader, [interceptor_x], interceptor, reaches, others])


def _between(low: float, high: float, unit: float) -> float:
    return low + (high - low) * 0.5 * (unit + 1.0)
