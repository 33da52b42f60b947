"""Rule-based policies: the navigation expert (§4.1), defensive dragging (§4.4, Fig. 11), and chance."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from agents.features import subtask_number
from agents.task import FloatArray, IntArray, Layout

MAX_TURN_RAD = math.pi / 2
"""Largest turning angle an action may ask for [rad] (§2.3)."""


class NavigationExpert:
    """Heads for the exit and ignores every missile: the expert of source task 4."""

    name = "expert-navigation"
    layout = None

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Turn by the azimuth of the exit, within what one action allows; `[B, 1]` [rad]."""
        exit_azimuth = observation[:, [layout.names.index("phi_exit")]]
        return np.clip(exit_azimuth, -MAX_TURN_RAD, MAX_TURN_RAD)


class DraggingExpert:
    """Defensive dragging (§4.4): keeps the closest missile at a fixed angle off the nose, ignores all others.

    Of the two sides it takes the one that needs the smaller turn. When no missile flies it navigates.
    """

    layout = None

    def __init__(self, angle_rad: float = math.pi / 2) -> None:
        """Keep the closest missile at ± `angle_rad` off the nose; the paper's expert holds 90°."""
        self.angle_rad = angle_rad
        self.name = "expert-dragging"
        if angle_rad != math.pi / 2:
            self.name += f"-{math.degrees(angle_rad):.0f}"
        self._navigation = NavigationExpert()

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Turning angles `[B, 1]` [rad] for observations `[B, d]`."""
        navigate = self._navigation.act(observation, layout)
        ranges, azimuths = missile_columns(layout.names)
        if len(ranges) == 0:
            return navigate
        range_m = observation[:, ranges]
        range_m = np.where(range_m < 0.0, np.inf, range_m)  # -1 stands for "does not fly"
        closest = range_m.argmin(axis=1)
        rows = np.arange(len(observation))
        drag = drag_turn(observation[rows, azimuths[closest]], self.angle_rad)[:, None]
        flying = np.isfinite(range_m[rows, closest])[:, None]
        return np.where(flying, np.clip(drag, -MAX_TURN_RAD, MAX_TURN_RAD), navigate)


class RandomPolicy:
    """Draws every turning angle uniformly: the floor every other policy is compared with."""

    name = "random"
    layout = None

    def __init__(self, seed: int = 0) -> None:
        """Start a sequence of actions of its own."""
        self.generator = np.random.default_rng(seed)

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Random turning angles `[B, 1]` [rad]."""
        turn = self.generator.uniform(-MAX_TURN_RAD, MAX_TURN_RAD, (len(observation), 1))
        return turn.astype(np.float32)


def drag_turn(azimuth_rad: FloatArray, angle_rad: float) -> FloatArray:
    """Smallest turn `[B]` [rad] that puts a missile at this azimuth `[B]` at +angle or -angle off the nose.

    Turning left by Δψ moves everything Δψ to the right, so the missile ends at azimuth - Δψ.
    """
    to_left = wrap_to_pi(azimuth_rad - np.float32(angle_rad))
    to_right = wrap_to_pi(azimuth_rad + np.float32(angle_rad))
    return np.where(np.abs(to_left) <= np.abs(to_right), to_left, to_right)


@cache
def missile_columns(names: tuple[str, ...]) -> tuple[IntArray, IntArray]:
    """Columns of the ranges and of the azimuths of all missiles among columns, by ascending missile number."""
    missiles = sorted({subtask_number(name) for name in names} - {0})
    ranges = [names.index(f"r_{missile}") for missile in missiles]
    azimuths = [names.index(f"phi_{missile}") for missile in missiles]
    return np.array(ranges, int), np.array(azimuths, int)


def wrap_to_pi(angle_rad: FloatArray) -> FloatArray:
    """The same angle in (-π, π] [rad]."""
    turn = np.float32(2.0 * math.pi)
    return -((np.float32(math.pi) - angle_rad) % turn - np.float32(math.pi))
