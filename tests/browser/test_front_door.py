"""A person follows the printed link, and goes from page to page."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.conftest import Served

PAGES = ["fly", "curriculum", "live", "runs"]


def test_the_link_leads_to_the_first_page_without_the_token(visitor: Page, served: Served) -> None:
    visitor.context.clear_cookies()
    visitor.goto(served.link)
    expect(visitor).to_have_title("Fly · SubMas workbench")
    assert visitor.url.startswith(f"{served.address}/fly")
    assert served.token not in visitor.url


@pytest.mark.parametrize("name", PAGES)
def test_every_page_opens(visitor: Page, served: Served, name: str) -> None:
    visitor.goto(f"{served.address}/{name}")
    expect(visitor.get_by_role("link", name=name.title(), exact=True)).to_be_visible()
    expect(visitor.get_by_text("cannot be shown")).to_have_count(0)


def test_components_are_loaded_by_the_browser_itself(visitor: Page, served: Served) -> None:
    """Read and rewritten by a script they would cost each page a quarter of a second."""
    visitor.goto(f"{served.address}/paper")
    expect(visitor.locator("[data-verdict]").first).to_be_visible()
    script = """() => performance.getEntriesByType("resource")
        .filter((entry) => entry.name.includes("panel-material-ui.bundle.js")).map((entry) => entry.initiatorType)"""
    kinds = visitor.evaluate(script)
    assert kinds and "fetch" not in kinds, kinds


def test_the_navigation_and_the_colours_go_along(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/live")
    visitor.get_by_role("button", name="Toggle theme").click()
    link = visitor.get_by_role("link", name="Runs", exact=True)
    expect(link).to_have_attribute("href", "/runs?theme=default")
    link.click()
    expect(visitor).to_have_title("Runs · SubMas workbench")
    expect(visitor.locator(".mui-light").first).to_be_visible()


def test_a_stranger_is_told_what_to_do(page: Page, served: Served) -> None:
    page.goto(f"{served.address}/fly")
    expect(page.get_by_text("open the address that `workbench serve` printed")).to_be_visible()


def test_a_page_of_another_site_gets_nothing(page: Page, served: Served) -> None:
    page.goto(f"{served.address}/healthz?token={served.token}")  # the cookie is there
    page.goto(served.address.replace("127.0.0.1", "localhost") + "/healthz")  # another site on the same machine
    script = """async (address) => {
        const read = await fetch(address + "/healthz", {credentials: "include"}).then(() => "read", () => "refused")
        const socket = new WebSocket(address.replace("http", "ws") + "/fly/ws", ["bokeh", "x"])
        const opened = await new Promise((done) => {
            socket.onopen = () => done("opened")
            socket.onerror = () => done("refused")
        })
        return [read, opened]
    }"""
    assert page.evaluate(script, served.address) == ["refused", "refused"]
