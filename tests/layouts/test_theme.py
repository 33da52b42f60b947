"""Colours read on dark and on light."""

from __future__ import annotations

import numpy as np
import pytest

from layouts import theme
from layouts.rewards import GOAL_INK, TIME_INK

SIGHTS = {
    "normal": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
"""What linear RGB looks like without red, green or blue cones (Machado, Oliveira and Fernandes 2009, severity 1)."""
LMS = [[0.41222, 0.53633, 0.05145], [0.21190, 0.68070, 0.10740], [0.08830, 0.28172, 0.62998]]
OKLAB = [[0.21045, 0.79362, -0.00407], [1.97800, -2.42859, 0.45059], [0.02590, 0.78277, -0.80868]]

BODIES = [theme.POLICY_A, theme.POLICY_B, theme.INTERCEPTOR, *theme.MISSILES]
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


def _seen(colour: str, sight: object) -> np.ndarray:
    """Place of a colour in Oklab, where distances are differences that people see (Ottosson 2020)."""
    linear = np.array(
        [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in np.array(theme.rgb(colour)) / 255]
    )
    return np.asarray(OKLAB) @ np.cbrt(np.asarray(LMS) @ np.clip(np.asarray(sight) @ linear, 0.0, 1.0))


@pytest.mark.parametrize("sight", SIGHTS)
def test_missiles_five_to_eight_are_told_from_all_others_whatever_the_colour_vision(sight: str) -> None:
    places = [_seen(colour, SIGHTS[sight]) for colour in theme.MISSILES]
    for one in range(4, 8):
        for other in set(range(8)) - {one}:
            assert np.linalg.norm(places[one] - places[other]) > 0.085, (one + 1, other + 1)


def test_no_curve_of_the_second_four_is_told_by_colour_alone() -> None:
    assert [theme.ink_dash(theme.missile_colour(number)) for number in range(1, 9)] == ["solid"] * 4 + ["dashed"] * 4


def test_blending_ends_at_both_colours() -> None:
    red, blue = (200, 0, 0), (0, 0, 100)
    assert theme.blend(red, blue, 0.0) == red
    assert theme.blend(red, blue, 1.0) == blue
    assert theme.blend(red, blue, 0.5) == (100, 0, 50)


def test_scene_inks_move_away_from_the_ground() -> None:
    dark, light = (theme.scene_ink(theme.POLICY_A, theme.ground(mode)) for mode in ("dark", "light"))
    assert _luminance(dark) > _luminance(theme.rgb(theme.POLICY_A)) > _luminance(light)
