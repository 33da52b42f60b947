"""Colours read on dark and on light."""

from __future__ import annotations

import pytest

from layouts import theme
from layouts.rewards import GOAL_INK, TIME_INK

BODIES = [theme.POLICY_A, theme.POLICY_B, theme.INTERCEPTOR, *theme.MISSILES[:4]]
INKS = [*BODIES, theme.SUCCESS, theme.NEUTRAL, GOAL_INK, TIME_INK]


def _luminance(colour: theme.Rgb) -> float:
    parts = [value / 255 for value in colour]
    red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _contrast(one: theme.Rgb, other: theme.Rgb) -> float:
    low, high = sorted((_luminance(one), _luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("ink", INKS)
@pytest.mark.parametrize("paper", ["#ffffff", "#121212"])
def test_every_ink_stands_out_from_both_papers(ink: str, paper: str) -> None:
    assert _contrast(theme.rgb(ink), theme.rgb(paper)) > 2.5


def test_missiles_and_aircraft_have_colours_of_their_own() -> None:
    assert len(set(BODIES)) == len(BODIES)


def test_every_missile_a_scenario_may_have_gets_a_colour() -> None:
    assert {theme.missile_colour(number) for number in range(1, 9)} == set(theme.MISSILES)


def test_blending_ends_at_both_colours() -> None:
    red, blue = (200, 0, 0), (0, 0, 100)
    assert theme.blend(red, blue, 0.0) == red
    assert theme.blend(red, blue, 1.0) == blue
    assert theme.blend(red, blue, 0.5) == (100, 0, 50)


def test_scene_inks_move_away_from_the_ground() -> None:
    dark, light = (theme.scene_ink(theme.POLICY_A, theme.ground(mode)) for mode in ("dark", "light"))
    assert _luminance(dark) > _luminance(theme.rgb(theme.POLICY_A)) > _luminance(light)
