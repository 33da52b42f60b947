"""The sheet of keyboard shortcuts and the legend of symbols, opened by `?` or its button."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import FAILURE, GATE, INTERCEPTOR, POLICY_A, POLICY_B, missile_colour

KEYS = [
    ["Space", "play, pause"],
    ["← →", "one decision step (1 s) back, on"],
    ["Shift ← →", "ten seconds back, on"],
    [", .", "a tenth of a second back, on"],
    ["[ ]", "previous, next event"],
    ["Home End", "begin, end"],
    ["− +", "slower, faster"],
    ["c", "next camera"],
    ["?", "this sheet; Esc closes it"],
]
SYMBOLS = [
    ["craft", POLICY_A, "evader of flight A"],
    ["craft", POLICY_B, "evader of flight B"],
    ["craft", INTERCEPTOR, "interceptor, which fires the missiles"],
    ["dot", missile_colour(1), "missile; every missile keeps its colour on all pages"],
    ["ring", missile_colour(1), "missile evaded: the end of its curve, a small ball in 3-D"],
    ["cross", FAILURE, "hit: the end of its curve, a burst in 3-D"],
    ["thick", POLICY_A, "trail: the last 75 s; the whole path is faint"],
    ["drop", POLICY_A, "down to the ground; heights are drawn four times as high"],
    ["thin", missile_colour(2), "line of sight from the evader to a missile in flight"],
    ["dashes", POLICY_A, "±90° off the nose, the beam: where dragging holds the closest missile"],
    ["bar", "#f2b705", "energy a missile has left, of its greatest"],
    ["gate", GATE, "exit"],
    ["ticks", missile_colour(3), "events on the clock: flight A above, flight B below"],
    ["shade", "#7d8794", "no transfer: a missile shows that the guide does not know (Eq. 13)"],
    ["arrows", "#7d8794", "▼ comes closer, ▲ moves away; azimuth + is left of the nose"],
]


class HelpSheet(JSComponent):
    """A button, and the dialog that it opens."""

    keys = param.List(default=KEYS, doc="pairs of keys and what they do")
    symbols = param.List(default=SYMBOLS, doc="shape, colour and meaning of everything drawn")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
