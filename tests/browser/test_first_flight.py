"""The main job, once through: see both flights, move the one clock, train a stage, fly what was learned."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.browser.places import box_of
from tests.conftest import Served

REPLAY = "iframe[title='3-D replay of both flights']"
RERUN = "iframe[title='Rerun viewer']"


def _picture(view: Locator) -> NDArray[np.int16]:
    """What a person sees of a view, `[height, width, 3]`."""
    return np.asarray(Image.open(io.BytesIO(view.screenshot())).convert("RGB"), dtype=np.int16)


def _share_drawn(picture: NDArray[np.int16]) -> float:
    """Share of pixels that differ clearly from the background, the most common colour."""
    colours, counts = np.unique(picture.reshape(-1, 3), axis=0, return_counts=True)
    background = colours[counts.argmax()]
    return float((np.abs(picture - background).max(axis=2) > 40).mean())


def _share_moved(before: NDArray[np.int16], after: NDArray[np.int16]) -> float:
    return float((np.abs(before - after).max(axis=2) > 40).mean())


def _colours_near(picture: NDArray[np.int16], colour: tuple[int, int, int]) -> int:
    return int((np.abs(picture - np.array(colour)).max(axis=2) < 30).sum())


def _drag_clock(person: Page, share: float) -> None:
    """Drag the thumb of the one clock to a share of its track, with the mouse."""
    rail = person.locator(".clock .rail")
    box = box_of(rail)
    at = float(rail.input_value()) / float(rail.get_attribute("max") or 1)
    y = box["y"] + box["height"] / 2
    person.mouse.move(box["x"] + 8 + at * (box["width"] - 16), y)
    person.mouse.down()
    person.mouse.move(box["x"] + 8 + share * (box["width"] - 16), y, steps=8)
    person.mouse.up()


def _settled(person: Page, view: Locator) -> NDArray[np.int16]:
    """The view once two looks, half a second apart, agree."""
    picture = _picture(view)
    for _ in range(40):
        person.wait_for_timeout(500)
        later = _picture(view)
        if _share_moved(picture, later) < 1e-4:
            return later
        picture = later
    return picture


def _moves(person: Page, view: Locator, before: NDArray[np.int16]) -> bool:
    """Whether the view comes to differ from a picture of it; software rendering takes its time."""
    for _ in range(60):
        if _share_moved(before, _picture(view)) > 2e-4:
            return True
        person.wait_for_timeout(500)
    return False


def _open_flights(person: Page, workbench: Served, query: str) -> None:
    person.goto(f"{workbench.address}/fly{query}")
    expect(person.locator(".card.exit, .card.failed")).to_have_count(2)
    expect(person.locator(".view .cover.gone")).to_have_count(1)


def test_both_flights_are_drawn_and_one_clock_moves_every_view(person: Page, workbench: Served) -> None:
    _open_flights(person, workbench, "?seed=2&t=0")
    replay, curves = person.locator(REPLAY), person.locator(".bk-Figure").first
    space, plot = _settled(person, replay), _settled(person, curves)
    assert _share_drawn(space) > 0.01
    # Fig. 12: one curve a missile, in the colours of the missile chips.
    for chip in range(1, 5):
        style = person.get_by_role("button", name=f"Missile {chip}", exact=True).evaluate(
            "node => getComputedStyle(node).backgroundColor"
        )
        colour = tuple(int(part) for part in style[style.index("(") + 1 : -1].split(",")[:3])
        assert _colours_near(plot, colour) > 20, f"no curve of missile {chip}"  # type: ignore[arg-type]

    _drag_clock(person, 0.35)
    expect(person.locator(".clock .now")).not_to_have_text("0:00")
    assert _moves(person, replay, space)
    assert _moves(person, curves, plot)
    expect(person.locator(".events button.latest")).to_have_count(1)

    person.get_by_role("tab", name="Rerun").click()
    expect(person.locator(".pane .cover.gone")).to_have_count(1)
    rerun = person.locator(RERUN)
    recording = _settled(person, rerun)
    assert _share_drawn(recording) > 0.01
    _drag_clock(person, 0.45)
    assert _moves(person, rerun, recording)
