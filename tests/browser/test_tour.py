"""The tour: once by itself, over all pages, by keyboard, and never in the way of an address that shows something."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.browser.conftest import TRAINING_PATIENCE_MS
from tests.conftest import Served
from workbench.app import PAGES
from workbench.tour import STOPS


def _arrive(page: Page, address: str) -> None:
    """As a person would: nothing says that a program drives this browser."""
    page.add_init_script("Object.defineProperty(navigator, 'webdriver', {get: () => false})")
    page.goto(address)


def test_the_first_visit_is_welcomed_once(visitor: Page, served: Served) -> None:
    _arrive(visitor, f"{served.address}/")
    note = visitor.get_by_role("dialog", name="Welcome")
    expect(note.get_by_role("button", name="Start")).to_be_focused()
    visitor.keyboard.press("Escape")
    expect(note).to_be_hidden()
    expect(visitor.get_by_role("button", name="Take the tour")).to_be_focused()
    visitor.goto(f"{served.address}/fly")
    expect(visitor.get_by_role("button", name="Take the tour")).to_be_visible()
    expect(note).to_be_hidden()


def test_an_address_that_shows_something_is_left_alone(visitor: Page, served: Served) -> None:
    _arrive(visitor, f"{served.address}/curriculum?mask=2")
    expect(visitor.get_by_text("Missiles 1, 3, 4", exact=True).first).to_be_visible()
    expect(visitor.get_by_role("dialog")).to_have_count(0)
    visitor.goto(f"{served.address}/fly?mask=4")
    expect(visitor.get_by_role("button", name="Take the tour")).to_be_visible()
    expect(visitor.get_by_role("dialog")).to_have_count(0)
    assert visitor.evaluate("localStorage.getItem('submas-tour-seen')") is None


def test_the_tour_walks_over_every_page_and_back(visitor: Page, served: Served) -> None:
    stops = [stop for stop in STOPS if stop.page in ("", *PAGES)]
    expect.set_options(timeout=TRAINING_PATIENCE_MS)  # six pages, one after the other
    visitor.goto(f"{served.address}/curriculum?mask=3")
    visitor.get_by_role("button", name="Take the tour").click()
    for stop in stops:
        note = visitor.get_by_role("dialog", name=stop.head)
        expect(note).to_be_visible()
        if stop.page:
            expect(visitor).to_have_url(re.compile(f"/{stop.page}([?]|$)"))
        visitor.keyboard.press("ArrowRight" if stop is not stops[-1] else "Enter")
    expect(visitor).to_have_url(re.compile(r"/curriculum\?.*mask=3"))
    expect(visitor.get_by_text("Missiles 1, 2, 4", exact=True).first).to_be_visible()
    expect(visitor.get_by_role("dialog")).to_have_count(0)


def test_the_page_under_the_tour_can_be_used(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/curriculum")
    expect(visitor.get_by_role("button", name="Missile 4", exact=True)).to_be_visible()
    visitor.get_by_role("button", name="Take the tour").click()
    expect(visitor.get_by_role("dialog", name="Welcome")).to_be_visible()
    visitor.get_by_role("button", name="Missile 4", exact=True).click()
    expect(visitor.get_by_text("13 of 15 numbers")).to_be_visible()
    visitor.get_by_role("button", name="Skip").click()
    expect(visitor.get_by_role("dialog")).to_have_count(0)
