"""For eyes, ears and windows of all kinds: every page, dark and light, passes axe and fits narrow and wide windows."""

from __future__ import annotations

import re

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.conftest import Served
from workbench.bench.openings import READY

RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
EMPTY = {"runs": "[aria-label='Search runs']"}
"""What stands on a page while there are no runs, where that is something else."""
WINDOWS = ((1024, 768), (2560, 1440))
STICKS_OUT = """width => {
  const found = [], kinds = "button, input, select, a, h1, h2, h3, legend"
  const shown = (node, box) => box.width > 0 && box.height > 0 &&
    node.checkVisibility({checkOpacity: true, checkVisibilityCSS: true})
  const look = (root) => {
    for (const node of root.querySelectorAll("*")) {
      if (node.shadowRoot) { look(node.shadowRoot) }
      const box = node.getBoundingClientRect()
      if (node.matches(kinds) && shown(node, box) && (box.left < -1 || box.right > width + 1)) {
        found.push(`${node.tagName} ${node.textContent.slice(0, 40)}`)
      }
    }
  }
  look(document)
  return found.concat(document.scrollingElement.scrollWidth > innerWidth ? ["the page scrolls sideways"] : [])
}"""


def _complaints(page: Page) -> list[str]:
    page.wait_for_timeout(500)  # transitions of opacity count as little contrast
    found = Axe().run(page, options={"runOnly": RULES, "resultTypes": ["violations"]}).response["violations"]
    return [f"{one['id']}: {one['help']}: {node['html'][:120]}" for one in found for node in one["nodes"]]


def _open(page: Page, served: Served, name: str, colours: str) -> None:
    page.goto(f"{served.address}/{name}?theme={colours}")
    expect(page.locator(EMPTY.get(name, READY[name])).first).to_be_visible()


@pytest.mark.parametrize("name", list(READY))
def test_a_page_passes_axe_and_fits(visitor: Page, served: Served, name: str) -> None:
    _open(visitor, served, name, "dark")
    assert _complaints(visitor) == []
    _open(visitor, served, name, "default")
    assert _complaints(visitor) == []
    for width, height in WINDOWS:
        visitor.set_viewport_size({"width": width, "height": height})
        visitor.wait_for_timeout(300)
        assert visitor.evaluate(STICKS_OUT, width) == []


def test_axe_would_find_a_button_without_a_name(visitor: Page, served: Served) -> None:
    _open(visitor, served, "curriculum", "dark")
    visitor.evaluate("document.body.append(document.createElement('button'))")
    assert any(line.startswith("button-name") for line in _complaints(visitor))


def test_a_button_outside_the_window_would_be_found(visitor: Page, served: Served) -> None:
    _open(visitor, served, "curriculum", "dark")
    far = "<button style='position: fixed; left: 1400px; width: 90px'>Far</button>"
    visitor.evaluate("(far) => document.body.insertAdjacentHTML('beforeend', far)", far)
    assert visitor.evaluate(STICKS_OUT, 1440) == ["BUTTON Far"]


@pytest.mark.parametrize("key", ["Enter", "Space", "ArrowDown"])
def test_a_list_of_choices_is_opened_walked_and_closed_by_key(visitor: Page, served: Served, key: str) -> None:
    visitor.goto(f"{served.address}/fly")
    policy = visitor.get_by_role("combobox", name="Policy A")
    expect(policy).to_have_text(re.compile("SubMas-RL, target task"))
    policy.press(key)
    choices = visitor.get_by_role("listbox")
    expect(choices).to_contain_text("Navigation (expert)")
    visitor.keyboard.press("Escape")
    expect(choices).to_be_hidden()
    expect(policy).to_have_text(re.compile("SubMas-RL, target task"))
    policy.press(key)
    expect(choices).to_be_visible()
    visitor.keyboard.press("End")
    visitor.keyboard.press("Enter")
    expect(policy).not_to_have_text(re.compile("SubMas-RL, target task"))
    expect(visitor).to_have_url(re.compile(r"[?&]a=(?!submas-target)"))
