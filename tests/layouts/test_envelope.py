"""Pictures of envelopes: what is where, in which colour, and equal bytes for equal maps."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from layouts.envelope import Scale, grid_map, picture, polar_map
from layouts.survival import SHOT_DOWN, SURVIVED, edges
from layouts.theme import rgb

RANGES = np.linspace(5e3, 60e3, 12)
ASPECTS = np.radians(np.arange(-180.0, 180.0, 30.0))


def colour_at(figure: Figure, x: float, y: float) -> NDArray[np.uint8]:
    """Colour drawn at a place of the data."""
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    canvas.draw()
    drawn = np.asarray(canvas.buffer_rgba())
    column, row = figure.axes[0].transData.transform((x, y))
    return drawn[len(drawn) - 1 - round(row), round(column), :3]


def is_colour(found: NDArray[np.uint8], colour: str) -> bool:
    return bool(np.abs(found.astype(int) - np.array(rgb(colour))).max() <= 3)


def one_side(left: bool) -> NDArray[np.float64]:
    """A map in which only shots from one side are survived."""
    side = ASPECTS > 0.0 if left else ASPECTS < 0.0
    return np.broadcast_to(side, (12, 12)).astype(float)


@pytest.mark.parametrize("left", [True, False])
def test_left_of_the_nose_is_left_in_the_picture(left: bool) -> None:
    figure = polar_map(RANGES, ASPECTS, one_side(left), "title", "caption")
    at_left, at_right = colour_at(figure, math.radians(95.0), 36.0), colour_at(figure, math.radians(-95.0), 36.0)
    assert is_colour(at_left, SURVIVED if left else SHOT_DOWN)
    assert is_colour(at_right, SHOT_DOWN if left else SURVIVED)
    column, _ = figure.axes[0].transData.transform((math.radians(90.0), 36.0))
    assert column < figure.axes[0].transData.transform((0.0, 0.0))[0]


def test_the_nose_is_up_and_range_goes_outward() -> None:
    survived = np.broadcast_to(RANGES[:, None] > 30e3, (12, 12)).astype(float)
    figure = polar_map(RANGES, ASPECTS, survived, "title", "caption")
    assert is_colour(colour_at(figure, 0.1, 52.0), SURVIVED)
    assert is_colour(colour_at(figure, 0.1, 15.0), SHOT_DOWN)
    to_pixels = figure.axes[0].transData.transform
    assert to_pixels((0.0, 50.0))[1] > to_pixels((0.0, 10.0))[1] > to_pixels((math.pi, 10.0))[1]


def test_a_rectangle_has_x_to_the_right_and_y_upwards() -> None:
    x, y = Scale("launch range", "m", (10e3, 20e3, 30e3)), Scale("missile burn", "s", (4.0, 6.0))
    survived = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 1.0]])
    figure = grid_map(x, y, survived, "title", "caption")
    assert is_colour(colour_at(figure, 31.0, 6.2), SURVIVED)
    assert is_colour(colour_at(figure, 31.0, 4.2), SHOT_DOWN)
    assert is_colour(colour_at(figure, 11.0, 6.2), SHOT_DOWN)
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("launch range [km]", "missile burn [s]")


def test_shares_have_a_line_at_one_half_and_a_bar() -> None:
    x, y = Scale("a", "", (1.0, 2.0, 3.0)), Scale("b", "", (1.0, 2.0))
    shares = np.array([[0.0, 0.1], [0.4, 0.6], [0.9, 1.0]])
    assert len(grid_map(x, y, shares, "t", "c").axes) == 2
    sharp = grid_map(x, y, shares.round(), "t", "c")
    assert len(sharp.axes) == 1
    assert [text.get_text() for text in sharp.legends[0].get_texts()] == ["shot down", "survived"]


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_equal_maps_give_equal_bytes(kind: str) -> None:
    shares = np.random.default_rng(0).uniform(size=(12, 12)).round(1)
    one, other = (picture(polar_map(RANGES, ASPECTS, shares, "t", "c"), kind) for _ in range(2))  # type: ignore[arg-type]
    assert one == other
    assert picture(polar_map(RANGES, ASPECTS, 1.0 - shares, "t", "c"), kind) != one  # type: ignore[arg-type]


def test_a_picture_is_small_and_as_large_as_it_says() -> None:
    fine = polar_map(np.linspace(5e3, 60e3, 200), np.radians(np.arange(-180.0, 180.0, 5.0)), np.eye(200, 72), "t", "c")
    data = picture(fine, "png")
    assert len(data) < 200_000
    assert Image.open(io.BytesIO(data)).size == (768, 792)
    assert len(picture(fine, "svg")) < 200_000


def test_cells_meet_half_way_between_their_centres() -> None:
    assert edges(np.array([1.0, 2.0, 4.0])).tolist() == [0.5, 1.5, 3.0, 5.0]


def test_the_two_colours_differ_in_brightness() -> None:
    # For eyes that see no colour, and for paper that prints none.
    light, dark = (np.array(rgb(colour)) @ [0.299, 0.587, 0.114] for colour in (SHOT_DOWN, SURVIVED))
    assert light - dark > 60.0
