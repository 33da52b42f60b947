"""Nothing leaves the machine: whatever a page asks for comes from the workbench itself."""

from __future__ import annotations

from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Page, Request, WebSocket, expect

from tests.conftest import Served
from workbench.bench.openings import READY

ANYWHERE = ("http", "https", "ws", "wss")


@pytest.fixture
def answered(page: Page, served: Served) -> Iterator[list[str]]:
    """Addresses of other machines that were really asked: what the content policy refuses never leaves."""
    found: list[str] = []

    def look(url: str) -> None:
        place = urlsplit(url)
        if place.scheme in ANYWHERE and place.hostname != "127.0.0.1":
            found.append(url)

    def failed(request: Request) -> None:
        if request.failure != "csp":
            look(request.url)

    page.context.on("requestfinished", lambda request: look(request.url))
    page.context.on("requestfailed", failed)

    def opened(socket: WebSocket) -> None:
        look(socket.url)

    page.on("websocket", opened)
    yield found


def test_no_page_asks_another_machine(visitor: Page, served: Served, answered: list[str]) -> None:
    for name, ready in READY.items():
        visitor.goto(f"{served.address}/{name}")
        if name != "runs":  # an empty folder of runs has no rows
            expect(visitor.locator(ready).first).to_be_visible()
    assert answered == []


def test_not_even_the_viewer_of_recordings_does(visitor: Page, served: Served, answered: list[str]) -> None:
    visitor.goto(f"{served.address}/fly?tab=rerun")
    expect(visitor.locator("iframe[title='Rerun viewer']")).to_be_visible()
    visitor.wait_for_timeout(4000)
    assert answered == []


def test_the_watch_would_notice(page: Page, served: Served, answered: list[str]) -> None:
    """Without our content policy the same look finds the request, whether or not anybody is there to answer."""
    page.goto("about:blank")
    page.context.set_offline(True)
    page.evaluate("fetch('http://example.org/').catch(() => 0)")
    page.wait_for_timeout(500)
    assert answered == ["http://example.org/"]
