"""A family of rule policies around defensive dragging: the plans that show whether an engagement can be won."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from agents.expert import MAX_TURN_RAD, NavigationExpert, drag_turn, missile_columns, wrap_to_pi
from agents.task import FloatArray, Layout

SIDES = ("turn", "centre", "exit", "left", "right")
"""How a rule picks the side: the smaller turn, towards the centre line, towards the exit edge, +y, or -y."""

EDGE_MARGIN_M = 15e3
"""Chosen: room for a half circle at cruising speed and then some."""


@dataclass(frozen=True)
class DragRule:
    """Keep the closest missile at a constant angle; choose the side by a rule; turn inwards near an edge."""

    angle_rad: float
    """Angle between the nose and the closest missile [rad]."""
    side: str
    """One of `SIDES`."""
    edge_y_m: float = math.inf
    """Beyond this distance from the centre line [m] the side is the one that leads back."""

    layout = None

    @property
    def name(self) -> str:
        """Name in tables."""
        return f"drag-{math.degrees(self.angle_rad):.0f}-{self.side}"

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Turning angles `[B, 1]` [rad] for observations `[B, d]`."""
        navigate = NavigationExpert().act(observation, layout)
        ranges, azimuths = missile_columns(layout.names)
        if len(ranges) == 0:
            return navigate
        range_m = np.where(observation[:, ranges] < 0.0, np.inf, observation[:, ranges])
        closest = range_m.argmin(axis=1)
        azimuth = observation[np.arange(len(observation)), azimuths[closest]]
        turn = self._turn(azimuth, observation[:, layout.names.index("psi")], observation[:, layout.names.index("y")])
        flying = np.isfinite(range_m.min(axis=1))[:, None]
        return np.where(flying, np.clip(turn[:, None], -MAX_TURN_RAD, MAX_TURN_RAD), navigate)

    def _turn(self, azimuth: FloatArray, yaw: FloatArray, y: FloatArray) -> FloatArray:
        left, right = (
            wrap_to_pi(azimuth - np.float32(self.angle_rad)),
            wrap_to_pi(azimuth + np.float32(self.angle_rad)),
        )
        inward = np.where(-np.sign(y) * np.sin(yaw + left) >= -np.sign(y) * np.sin(yaw + right), left, right)
        chosen = self._side(azimuth, yaw, left, right, inward)
        return np.where(np.abs(y) > self.edge_y_m, inward, chosen)

    def _side(
        self, azimuth: FloatArray, yaw: FloatArray, left: FloatArray, right: FloatArray, inward: FloatArray
    ) -> FloatArray:
        if self.side == "turn":
            return drag_turn(azimuth, self.angle_rad)
        if self.side == "centre":
            return inward
        if self.side == "exit":
            return np.where(np.cos(yaw + left) >= np.cos(yaw + right), left, right)
        up = np.where(np.sin(yaw + left) >= np.sin(yaw + right), left, right)
        return up if self.side == "left" else np.where(up == left, right, left)


def edge_of(width_m: float) -> float:
    """Distance from the centre line [m] at which a rule turns back on a battlefield of this width [m]."""
    return width_m / 2 - EDGE_MARGIN_M


def rule_family(width_m: float) -> list[DragRule]:
    """Thirty plans for a battlefield of this width [m]: five ways to choose a side, six angles."""
    edge = edge_of(width_m)
    angles = [math.radians(degrees) for degrees in (75, 90, 105, 120, 140, 165)]
    return [DragRule(angle, side, edge) for side in SIDES for angle in angles]


class LoiterExpert:
    """Drags like the expert and, when no missile flies, circles instead of flying to the exit.

    Evading all four missiles and never leaving earns exactly 4 x 50 - 1200 x 0.1 = 80: the paper's local optimum.
    """

    name = "loiter"
    layout = None

    def __init__(self, rule: DragRule, circle_rad: float = 0.35) -> None:
        """Evade by `rule`; circle with a constant turning angle [rad]."""
        self._rule, self._circle = rule, circle_rad

    def act(self, observation: FloatArray, layout: Layout) -> FloatArray:
        """Turning angles `[B, 1]` [rad]."""
        ranges, _ = missile_columns(layout.names)
        flying = (observation[:, ranges] >= 0.0).any(axis=1, keepdims=True)
        return np.where(flying, self._rule.act(observation, layout), np.float32(self._circle))
