"""R21: a page that loses its server is current again or says what to do, and sends nothing twice."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from agents.config import TrainingConfig
from tests.conftest import Served, start_server
from tests.reliability.fake_training import metrics_row
from workbench.bench.page import SETTLED
from workbench.run_files import append_line
from workbench.runs import Run, RunStore

PATIENCE_MS = 60_000
BAR = "#connection-bar"
EMPTY = "No run yet. Launch one on the Curriculum page"


class Cable:
    """The way of every websocket of a page, which can be pulled out; what the page sends to the server is counted."""

    def __init__(self, page: Page) -> None:
        self.sent: list[str] = []
        self._open: list[WebSocketRoute] = []
        self._cut = False
        page.route_web_socket(re.compile(r"ws://[^?]*/ws(\?|$)"), self._connect)
        page.route("**/healthz", lambda route: route.abort() if self._cut else route.continue_())

    def _connect(self, page_side: WebSocketRoute) -> None:
        if self._cut:
            page_side.close(code=1012)
            return
        server_side = page_side.connect_to_server()
        page_side.on_message(lambda message: (self.sent.append(str(message)), server_side.send(message))[0])
        self._open.append(page_side)

    def pull(self) -> None:
        self._cut = True
        for each in self._open:
            each.close(code=1012)
        self._open.clear()

    def plug(self) -> None:
        self._cut = False


@pytest.fixture
def visitor(page: Page) -> Page:
    """A page with patience; that its requests fail is what is looked at here."""
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    return page


@pytest.fixture
def running(served: Served) -> Iterator[tuple[Run, Callable[[int], None]]]:
    """A run that learns as long as this process says so, and a way to end its next epoch."""
    run = RunStore(served.runs).create(TrainingConfig(profile="smoke", missiles=1, name="on the way"))
    lock = run.claim()

    def learn(epoch: int) -> None:
        append_line(run.path / "metrics.jsonl", metrics_row(epoch, 100))
        run.write_state(type(run.state)("running", task="target", progress=epoch / 100, pid=os.getpid()))

    learn(1)
    yield run, learn
    os.close(lock or 0)
    for path in sorted(run.path.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    run.path.rmdir()


def test_a_page_whose_connection_was_cut_is_current_again_and_pressed_nothing_twice(
    visitor: Page, served: Served, running: tuple[Run, Callable[[int], None]]
) -> None:
    run, learn = running
    cable = Cable(visitor)
    visitor.goto(f"{served.link}".replace("/?", f"/live?run={run.id}&"))
    expect(visitor.get_by_role("button", name="Pause")).to_be_visible()
    whole = visitor.get_by_role("progressbar", name="Progress of the whole run")
    expect(whole).to_have_attribute("aria-valuenow", "1")
    cable.pull()
    expect(visitor.locator(BAR)).to_contain_text("No answer: the workbench was stopped or cannot be reached")
    learn(37)
    said = len(cable.sent)
    visitor.get_by_role("button", name="Pause").dispatch_event("click")  # what covers the page by then is no matter
    visitor.wait_for_timeout(500)
    assert len(cable.sent) == said and not run.pause_requested()
    address = visitor.url
    cable.plug()
    expect(whole).to_have_attribute("aria-valuenow", "37")
    expect(visitor.locator(BAR)).to_be_hidden()
    assert visitor.url == address
    assert not run.pause_requested(), "what was pressed in between is not sent later"
    visitor.get_by_role("button", name="Pause").click()
    for _ in range(300):
        if run.pause_requested():
            break
        visitor.wait_for_timeout(100)
    assert run.pause_requested(), "and the page works again"


def test_a_stopped_server_and_one_that_was_started_again_are_sentences(visitor: Page, tmp_path: Path) -> None:
    first = start_server(tmp_path)
    try:
        visitor.goto(first.link.replace("/?", "/live?"))
        visitor.wait_for_function(SETTLED)
        visitor.get_by_role("link", name="Runs", exact=True).click()  # also a page that came in place of another
        expect(visitor.get_by_text(EMPTY).first).to_be_visible()
        expect(visitor.locator(BAR)).to_be_hidden()
    finally:
        first.process.kill()
        first.process.wait()
    expect(visitor.locator(BAR)).to_contain_text("Start it again (workbench serve) and open the address it prints.")
    again = [sys.executable, "-m", "workbench", "serve", "--port", str(first.port), "--no-browser", "--runs"]
    with (tmp_path / "again.log").open("w") as log:
        second = subprocess.Popen([*again, str(first.runs)], stdout=log, stderr=log)
    try:
        expect(visitor.locator(BAR)).to_contain_text("with a new token. Open the address it printed.")
        (link,) = re.findall(r"http://\S+token=\S+", (tmp_path / "again.log").read_text())
        visitor.goto(link.replace("/?", "/runs?"))
        expect(visitor.get_by_text(EMPTY).first).to_be_visible()
        expect(visitor.locator(BAR)).to_be_hidden()
    finally:
        second.terminate()
        second.wait(timeout=30)
