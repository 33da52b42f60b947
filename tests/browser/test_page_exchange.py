"""From page to page without loading everything anew: the document stays, and nothing of the page before."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.conftest import Served
from workbench.bench.page import SETTLED

MARK = "window.mark = 'the same document'"
SAME = "window.mark === 'the same document'"
STANDS = {
    "Fly": ".card.exit, .card.failed",
    "Curriculum": ".stage",
    "Live": "[aria-label=Trainings]",
    "Runs": "input[type=search]",
    "Compare": ".legend .swatch",
    "Paper": "[data-verdict]",
}
TEMPLATES = "[...Bokeh.documents[0]._all_models.values()].filter(({type}) => /ReactiveHTML/.test(type)).length"
HELD = "[Bokeh.documents.length, Bokeh.index.roots.length, document.querySelectorAll('body > [data-root-id]').length]"


def _go(page: Page, title: str) -> None:
    page.get_by_role("navigation", name="Pages").get_by_role("link", name=title, exact=True).click()
    _wait(page, title)


def _wait(page: Page, title: str) -> None:
    expect(page).to_have_title(f"{title} · SubMas workbench")
    expect(page.locator(STANDS[title]).first).to_be_visible()
    page.wait_for_function(SETTLED)


def _open(page: Page, address: str, title: str) -> None:
    page.goto(address)
    _wait(page, title)
    page.evaluate(MARK)


def test_every_page_comes_into_the_same_document_and_leaves_nothing_behind(visitor: Page, served: Served) -> None:
    sockets = []
    visitor.on("websocket", lambda socket: sockets.append(socket) if "/ws" in socket.url else None)
    _open(visitor, f"{served.address}/live", "Live")
    held = visitor.evaluate(HELD)
    for title in ("Runs", "Fly", "Curriculum", "Compare", "Paper", "Live"):
        _go(visitor, title)
        assert visitor.url.startswith(f"{served.address}/{title.lower()}")
        assert visitor.evaluate(SAME)
        assert visitor.evaluate(HELD) == held
        assert visitor.evaluate(TEMPLATES) == 0  # a browser would keep each page's for ever, see pages/wrapping.py
        expect(visitor.locator("nav[aria-label=Pages] [aria-current=page]")).to_have_text(title)
        expect(visitor.locator("#page-told[aria-live=polite]")).to_have_text(f"{title} · SubMas workbench")
    ours = [socket for socket in sockets if re.search(r"//[^/]+/[a-z]+/ws(\?|$)", socket.url)]
    assert len(ours) == 7
    assert [socket.is_closed() for socket in ours] == [True] * 6 + [False]


HEARING = """{
  const {addEventListener, removeEventListener} = EventTarget.prototype
  window.heard = new Set()
  EventTarget.prototype.addEventListener = function (type, listener, ...more) {
    if (this === visualViewport || this instanceof MediaQueryList) heard.add(listener)
    return addEventListener.call(this, type, listener, ...more)
  }
  EventTarget.prototype.removeEventListener = function (type, listener, ...more) {
    heard.delete(listener)
    return removeEventListener.call(this, type, listener, ...more)
  }
}"""


def test_what_a_page_hears_of_the_tab_is_let_go(visitor: Page, served: Served) -> None:
    # What listens to the tab itself is never collected, and holds the page that it belongs to.
    visitor.add_init_script(HEARING)
    _open(visitor, f"{served.address}/live", "Live")
    for title in ("Runs", "Live"):
        _go(visitor, title)
    heard = visitor.evaluate("heard.size")
    for title in ("Runs", "Live") * 2:
        _go(visitor, title)
    assert visitor.evaluate("heard.size") == heard


def test_a_page_that_was_exchanged_is_alive(visitor: Page, served: Served) -> None:
    _open(visitor, f"{served.address}/paper", "Paper")
    _go(visitor, "Fly")
    visitor.get_by_role("button", name="Missile 4", exact=True).click()
    expect(visitor.locator(".card", has_text="of 3").first).to_be_visible()
    expect(visitor).to_have_url(re.compile(r"/fly\?.*mask=4"))
    visitor.reload()
    expect(visitor.locator(".card", has_text="of 3").first).to_be_visible()


def test_back_and_forward_lead_through_the_pages_as_they_were(visitor: Page, served: Served) -> None:
    _open(visitor, f"{served.address}/compare?seed=7", "Compare")
    _go(visitor, "Paper")
    _go(visitor, "Live")
    visitor.go_back()
    _wait(visitor, "Paper")
    visitor.go_back()
    _wait(visitor, "Compare")
    expect(visitor.get_by_label("Seed", exact=True)).to_have_value("7")
    visitor.go_forward()
    _wait(visitor, "Paper")
    visitor.go_forward()
    _wait(visitor, "Live")
    assert visitor.evaluate(SAME)


def test_the_newest_link_wins(visitor: Page, served: Served) -> None:
    _open(visitor, f"{served.address}/live", "Live")
    links = visitor.get_by_role("navigation", name="Pages")
    links.get_by_role("link", name="Compare", exact=True).click(no_wait_after=True)
    links.get_by_role("link", name="Paper", exact=True).click(no_wait_after=True)
    expect(visitor.locator(STANDS["Paper"]).first).to_be_visible()
    expect(visitor).to_have_title("Paper · SubMas workbench")


def test_a_link_with_a_key_opens_a_tab_and_leaves_this_page_alone(visitor: Page, served: Served) -> None:
    _open(visitor, f"{served.address}/live", "Live")
    with visitor.context.expect_page() as opened:
        visitor.get_by_role("link", name="Runs", exact=True).click(modifiers=["Control"])
    expect(opened.value).to_have_title("Runs · SubMas workbench")
    expect(visitor).to_have_title("Live · SubMas workbench")
    assert visitor.evaluate(SAME)


def test_other_colours_are_loaded_anew(visitor: Page, served: Served) -> None:
    _open(visitor, f"{served.address}/live", "Live")
    visitor.get_by_role("button", name="Toggle theme").click()
    expect(visitor.get_by_role("link", name="Runs", exact=True)).to_have_attribute("href", "/runs?theme=default")
    _go(visitor, "Runs")
    assert not visitor.evaluate(SAME)
    visitor.evaluate(MARK)
    _go(visitor, "Paper")
    assert visitor.evaluate(SAME)
    expect(visitor.locator(".mui-light").first).to_be_visible()


def test_a_refusal_is_shown_as_the_server_words_it(page: Page, served: Served) -> None:
    _open(page, f"{served.link}".replace("/?", "/live?"), "Live")
    page.context.clear_cookies()
    page.get_by_role("link", name="Runs", exact=True).click()
    expect(page.get_by_text("open the address that `workbench serve` printed")).to_be_visible()
    assert page.url == f"{served.address}/runs"
