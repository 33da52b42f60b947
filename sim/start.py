"""Initial states rho (section 2.3): a function of seed and episode number alone, the same for every mask (Eq. 7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.scenario import Scenario


def initial_states(scenario: Scenario, seed: int, episodes: NDArray[np.integer]) -> NDArray[np.float32]:
    """Initial states `[n, 10 + M]` of numbered episodes; no mask is asked for, so every task has the same, Eq. (7).

    Columns are x, y, altitude [m], heading [rad] and speed [m/s] of the evader, the same of the interceptor, then the
    factor on the launch range of missiles 1..M.
    """
    return np.stack([_initial_state(scenario, seed, int(episode)) for episode in episodes]).astype(np.float32)


def _initial_state(scenario: Scenario, seed: int, episode: int) -> NDArray[np.float64]:
    # A counter-based generator keyed by (seed, episode): no episode depends on how many were drawn before it.
    draws = np.random.Generator(np.random.Philox(key=[seed, episode]))
    start, launch = scenario.start, scenario.launch
    unit = draws.uniform(-1.0, 1.0, 10 + launch.missiles)
    spreads = (start.y_spread_m, start.altitude_spread_m, start.heading_spread_rad, start.speed_spread_m_s)
    evader_x = _between(start.evader_x_low_m, start.evader_x_high_m, unit[0])
    interceptor_x = _between(start.interceptor_x_low_m, start.interceptor_x_high_m, unit[5])
    evader = (0.0, start.altitude_m, 0.0, start.evader_speed_m_s) + unit[1:5] * spreads
    interceptor = (0.0, start.altitude_m, np.pi, start.interceptor_speed_m_s) + unit[6:10] * spreads
    factors = 1.0 + launch.spread * unit[10:]
    return np.concatenate([[evader_x], evader, [interceptor_x], interceptor, factors])


def _between(low: float, high: float, unit: float) -> float:
    return low + (high - low) * 0.5 * (unit + 1.0)
