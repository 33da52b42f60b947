"""The instrument of somebody who flies by hand: a heading dial with the missiles around the nose, pause and speed."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import BRANCH, FILLED_CSS, missile_colour
from workbench.branch import FULL_CIRCLE_DEG
from workbench.branch_stick import Sight

SPEEDS = (1, 5, 10, 20)
"""Seconds of flight per second of steering that a person may choose."""


class HeadingDial(JSComponent):
    """Arrow keys or the mouse turn the heading that is asked for; space pauses. While seen, it takes these keys.

    Time begins with the first turn.
    """

    heading = param.Integer(default=0, bounds=(0, 359), doc="heading asked for [deg]; set by the browser")
    asked = param.List(default=[0, 0], doc="set to ask for a heading: degrees, and a count, to ask again")
    sight = param.Dict(default={}, doc="what is seen now, as `dial_sight` makes it")
    running = param.Boolean(default=True, doc="whether time goes on; set by both")
    speed = param.Integer(default=5, doc="set by the browser")
    speeds = param.List(default=list(SPEEDS), item_type=int)
    colour = param.String(default=BRANCH)

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [FILLED_CSS + Path(__file__).with_suffix(".css").read_text("utf-8")]

    def ask(self, heading_deg: int) -> None:
        """Ask for this heading as if the person had."""
        self.heading = heading_deg
        self.asked = [heading_deg, self.asked[1] + 1]


def dial_sight(sight: Sight) -> dict[str, Any]:
    """What the dial draws: time [s], speed [m/s], directions [deg]; number, direction, km and colour per missile."""
    missiles = [
        [number, _degrees(direction), round(range_m / 1e3, 1), missile_colour(number)]
        for number, direction, range_m in sight.missiles
    ]
    return {
        "time": sight.time_s,
        "heading": _degrees(sight.heading_rad),
        "exit": _degrees(sight.exit_rad),
        "speed": round(sight.speed_m_s),
        "missiles": missiles,
    }


def whole_heading(heading_rad: float) -> int:
    """A heading as the whole number of degrees, 0 to 359, that a branch holds."""
    return round(math.degrees(heading_rad)) % FULL_CIRCLE_DEG


def _degrees(angle_rad: float) -> float:
    return round(math.degrees(angle_rad) % FULL_CIRCLE_DEG, 1)
