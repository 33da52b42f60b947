"""Back and forward lead through what was chosen, not through every change of the address."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.conftest import Served


def test_back_takes_back_what_was_chosen_and_then_leaves(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/runs")
    expect(visitor.get_by_role("searchbox", name="Search runs")).to_be_visible()
    visitor.get_by_role("link", name="Fly", exact=True).click()
    expect(visitor.locator(".card", has_text="of 4").first).to_be_visible()
    visitor.get_by_role("button", name=re.compile("missile 1 launched")).first.click()
    expect(visitor).to_have_url(re.compile(r"[?&]t=\d"))
    visitor.get_by_role("button", name="Missile 4", exact=True).click()
    expect(visitor.locator(".card", has_text="of 3").first).to_be_visible()
    expect(visitor).to_have_url(re.compile(r"mask=4"))
    visitor.go_back()
    expect(visitor.locator(".card", has_text="of 4").first).to_be_visible()
    expect(visitor).not_to_have_url(re.compile(r"mask="))
    visitor.go_forward()
    expect(visitor.locator(".card", has_text="of 3").first).to_be_visible()
    visitor.go_back()
    expect(visitor.locator(".card", has_text="of 4").first).to_be_visible()
    visitor.go_back()
    expect(visitor).to_have_url(re.compile("/runs"))
