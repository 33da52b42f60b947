"""Names, contrast, structure: what axe finds on every page, dark and light, must be nothing."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.conftest import Served

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
THERE = {
    "fly": ".card.exit, .card.failed",
    "curriculum": ".stage",
    "live": "main h2, .empty, .MuiAlert-message, h2",
    "runs": "[aria-label='Search runs']",
    "compare": "td small, tr.close",
    "paper": "[data-verdict]",
}
"""What stands on each page once it has been filled."""


def _complaints(page: Page) -> list[str]:
    found = Axe().run(page, options={"runOnly": RULES, "resultTypes": ["violations"]}).response["violations"]
    return [f"{one['id']}: {one['help']}: {node['html'][:120]}" for one in found for node in one["nodes"]]


@pytest.mark.parametrize("colours", ["dark", "default"])
@pytest.mark.parametrize("name", list(THERE))
def test_axe_finds_nothing(visitor: Page, served: Served, name: str, colours: str) -> None:
    visitor.goto(f"{served.address}/{name}?theme={colours}")
    expect(visitor.locator(THERE[name]).first).to_be_visible()
    visitor.wait_for_timeout(500)  # transitions of opacity count as little contrast
    assert _complaints(visitor) == []


def test_axe_would_find_a_button_without_a_name(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/curriculum")
    expect(visitor.locator(".stage").first).to_be_visible()
    visitor.evaluate("document.body.append(document.createElement('button'))")
    assert any(line.startswith("button-name") for line in _complaints(visitor))
