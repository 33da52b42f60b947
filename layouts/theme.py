"""Colours of everything drawn: inks that read on dark and on light, and two grounds for 3-D scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]
Mode = Literal["dark", "light"]

# Mid-tone inks: each has a contrast of about 3:1 on white and on #121212, so a figure needs no redraw when
# the page changes between dark and light.
POLICY_A = "#2f86ff"
POLICY_B = "#e08a00"
BRANCH = "#ac39ac"
"""A branch of either flight. Searched: whatever the colour vision, it is not taken for a policy or the interceptor."""
INTERCEPTOR = "#e5414d"
FILLED = "#1a69d8"
"""Blue behind white words, and of words on a light page; policy A's own blue has too little contrast for either."""
FILLED_CSS = f":host {{ --filled: {FILLED} }}\n"
"""To stand before the style sheet of a component that fills a button: there it is `var(--filled)`."""
# The second four were searched: whatever the colour vision, none looks more like another ink of a missile than the
# first four look like each other. As curves they are dashed besides, so that colour never tells alone.
MISSILES = ("#9a63f5", "#1fa05f", "#e0489c", "#0f9fb5", "#986600", "#4a2cec", "#923a44", "#7e3da4")
DASHED = MISSILES[4:]
SUCCESS = "#1fa05f"
FAILURE = "#e5414d"
NEUTRAL = "#7d8794"
GATE = "#1fa05f"


@dataclass(frozen=True)
class Ground:
    """Colours of a 3-D scene that depend on dark or light."""

    background: Rgb
    field: Rgb
    grid: Rgb
    border: Rgb
    lift: float
    """How far inks are moved towards the far end (white on dark, black on light) in 3-D, 0 to 1."""
    faint: float
    """Share of the field's colour in a path that is not being flown just now, 0 to 1."""


DARK = Ground((13, 17, 23), (22, 29, 41), (41, 52, 70), (104, 122, 150), lift=0.12, faint=0.5)
LIGHT = Ground((247, 249, 252), (255, 255, 255), (176, 188, 206), (110, 125, 150), lift=0.05, faint=0.38)


def ground(mode: Mode) -> Ground:
    """The colours of a scene on a dark or a light page."""
    return DARK if mode == "dark" else LIGHT


def missile_colour(number: int) -> str:
    """Ink of a missile (1-based), the same in every figure, scene and recording."""
    return MISSILES[(number - 1) % len(MISSILES)]


def ink_dash(colour: str) -> Literal["solid", "dashed"]:
    """How a curve in this ink is drawn."""
    return "dashed" if colour in DASHED else "solid"


def rgb(colour: str) -> Rgb:
    """`#rrggbb` as three integers 0 to 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def hexadecimal(colour: Rgb) -> str:
    """Three integers 0 to 255 as `#rrggbb`."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def blend(colour: Rgb, other: Rgb, share: float) -> Rgb:
    """`colour` with `share` (0 to 1) of `other` mixed in: how opaque lines are made to look faint."""
    mixed: NDArray[np.float64] = np.asarray(colour) * (1.0 - share) + np.asarray(other) * share
    red, green, blue = (round(float(value)) for value in mixed)
    return red, green, blue


def scene_ink(colour: str, scene: Ground) -> Rgb:
    """An ink lifted away from the ground so that small bodies stay visible in 3-D."""
    far = (255, 255, 255) if sum(scene.background) < 384 else (0, 0, 0)
    return blend(rgb(colour), far, scene.lift)
