"""How long a person waits for the pages here: a server of its own, an empty cache, and a headless Chromium."""

from __future__ import annotations

import contextlib
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import SubMasError
from workbench.bench.runs import make_runs
from workbench.chromium import MISSING, find_chromium, headless_flags

if TYPE_CHECKING:
    from playwright.sync_api import Page

RUNS = 2000
SCRUB_S = 3.0
PATIENCE_S = 60.0
SETTLED = "Bokeh.documents[0]?.is_idle && !document.documentElement.classList.contains('exchanging')"
"""A page that is still being built is left by loading the next one anew, see page_exchange.js."""
STEPS = 6
NO_PLAYWRIGHT = "bench page drives a browser with Playwright, which is not installed; pip install playwright"
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/\?token=[\w-]+")
WARM_UP = """
import sys
from pathlib import Path
from workbench.context import AppContext
from workbench.warm_up import warm_up
warm_up(AppContext.of(Path(sys.argv[1])), later_s=0.0)
"""
COMPARED = "policies=submas-target,expert-dragging&tasks=target&episodes=1000&seed=1"
FOLLOW = """address => {
  const link = Object.assign(document.createElement("a"), {href: address})
  document.body.append(link)
  link.click()
  link.remove()
}"""
"""Follows an address in the tab that stands, as a link on one of the pages would."""
Progress = Callable[[int, int], None]

SCRUB = """async (milliseconds) => {
  const models = Bokeh.documents.flatMap(page => [...page._all_models.values()])
  const clock = models.map(model => model.data ?? model).find(model => "shown" in (model.attributes ?? {}))
  const {duration} = clock.attributes, seen = new Set()
  const pause = (wait) => new Promise(resolve => setTimeout(resolve, wait))
  const move = (detail) => window.dispatchEvent(new CustomEvent("flight-clock", {detail}))
  move(duration / 3)
  const arrived = () => Math.abs(clock.attributes.shown - duration / 3) < 1e-6
  for (let tries = 0; tries < 200 && !arrived(); tries++) { await pause(50) }
  const listen = () => seen.add(clock.attributes.shown)
  clock.properties.shown.change.connect(listen)
  const began = performance.now()
  for (let passed = 0; passed < milliseconds; passed = performance.now() - began) {
    move(duration * (0.5 - 0.5 * Math.cos(2 * Math.PI * passed / milliseconds)))
    await pause(16)
  }
  clock.properties.shown.change.disconnect(listen)
  return seen.size / ((performance.now() - began) / 1000)
}"""
"""Drags the clock to the end and back; how many instants a second Python has moved everything to."""


class BenchError(SubMasError):
    """The pages cannot be measured here."""


@dataclass(frozen=True)
class PageBench:
    """What `workbench bench page` measures: seconds from the click or the request until it is there."""

    server_start_s: float
    """From the command until the address answers."""
    first_page_s: float
    """The first visit of a server that has just started, by a browser that has just started: the clock of Fly."""
    flights_drawn_s: float
    """The same visit: both flights told of and drawn in three dimensions."""
    switch_s: float
    """A missile masked: both flights flown anew and told of (median of three, one after the other)."""
    scrub_hz: float
    """Instants shown per second while the clock is dragged."""
    runs_open_s: float
    """From the click on its link: the table of two thousand runs; the median of once from Fly and twice from Live."""
    runs_filter_s: float | None
    """On a page that stands: a name put into the search until only that run is left."""
    compare_s: float
    """Two policies flown through the same thousand engagements, until the paired table and its pictures are there."""


def bench_page(runs: int = RUNS, scrub_s: float = SCRUB_S, progress: Progress | None = None) -> PageBench:
    """Measure the pages with a folder of `runs` runs, dragging the clock for `scrub_s` seconds.

    Raises:
        BenchError: Playwright or Chromium is missing, or the server did not start.
    """
    chromium = ensure_browser()
    tell = progress or (lambda done, total: None)
    with tempfile.TemporaryDirectory(prefix="workbench-bench-") as folder:
        make_runs(Path(folder) / "runs", runs)
        _warm_up(Path(folder))
        began = time.perf_counter()
        with serving(Path(folder)) as server, browsing(chromium) as page:
            tell(1, STEPS)
            started_s = time.perf_counter() - began
            return _visit(page, server.link, started_s, scrub_s, tell, runs)


def ensure_browser() -> Path:
    """The Chromium to measure with.

    Raises:
        BenchError: Playwright or Chromium is missing.
    """
    if find_spec("playwright") is None:
        raise BenchError(NO_PLAYWRIGHT)
    chromium = find_chromium()
    if chromium is None:
        raise BenchError(MISSING)
    return chromium


def _visit(page: Page, link: str, started_s: float, scrub_s: float, tell: Progress, runs: int) -> PageBench:
    begin = time.perf_counter()
    page.goto(link)
    page.locator(".clock .now").wait_for()
    first_s = time.perf_counter() - begin
    page.locator(".card.exit, .card.failed").nth(1).wait_for()
    page.locator(".cover.gone").wait_for(state="attached")
    drawn_s = time.perf_counter() - begin
    tell(2, STEPS)
    scrub_hz = float(page.evaluate(SCRUB, 1000.0 * scrub_s))
    tell(3, STEPS)
    switch_s = sorted(_mask(page, missile) for missile in (4, 3, 2))[1]
    tell(4, STEPS)
    open_s, filter_s = _runs(page, runs)
    tell(5, STEPS)
    compare_s = _compare(page)
    tell(6, STEPS)
    return PageBench(started_s, first_s, drawn_s, switch_s, scrub_hz, open_s, filter_s, compare_s)


def _mask(page: Page, missile: int) -> float:
    """Seconds until both flights without this missile, one more than before, are told of."""
    cards = page.locator(".card", has_text=f"of {missile - 1}")
    begin = time.perf_counter()
    page.get_by_role("button", name=f"Missile {missile}", exact=True).click()
    return _until(lambda: cards.count() == 2, begin)


def _runs(page: Page, runs: int) -> tuple[float, float]:
    """Seconds until the table of runs stands, and until a search has left one of them (medians of three)."""
    opened = [_open_runs(page)]
    for _ in range(2):
        _link(page, "Live")
        page.get_by_label("Trainings").wait_for()
        opened.append(_open_runs(page))
    waits = [_search(page, f"bench-{number:04}") for number in (0, runs // 3, runs // 2)]
    return sorted(opened)[1], sorted(waits)[1]


def _open_runs(page: Page) -> float:
    begin = _link(page, "Runs")
    opened = _until(lambda: page.locator(".sheet .name .words", has_text="bench-").first.is_visible(), begin)
    page.get_by_text("Tick runs in the table").wait_for()  # what is below the table stands too
    return opened


def _link(page: Page, title: str) -> float:
    page.wait_for_function(SETTLED)
    begin = time.perf_counter()
    page.get_by_role("link", name=title, exact=True).click()
    return begin


def _search(page: Page, name: str) -> float:
    box, cells = page.get_by_role("searchbox", name="Search runs"), page.locator(".sheet .name .words")
    begin = time.perf_counter()
    box.fill(name)
    return _until(lambda: cells.all_inner_texts() == [name], begin)


def _until(there: Callable[[], bool], begin: float) -> float:
    """Seconds from `begin` until it is there. Playwright's own waiting looks up to half a second apart."""
    while not there():
        if time.perf_counter() - begin > PATIENCE_S:
            raise BenchError("the page did not answer within a minute")
        time.sleep(0.005)
    return time.perf_counter() - begin


def _compare(page: Page) -> float:
    page.wait_for_function(SETTLED)
    begin = time.perf_counter()
    page.evaluate(FOLLOW, f"/compare?{COMPARED}")
    page.locator("a.shot").first.wait_for()
    return time.perf_counter() - begin


@dataclass(frozen=True)
class Serving:
    """A running `workbench serve`."""

    link: str
    """Its address with the token."""
    pid: int


def _warm_up(folder: Path) -> None:
    """What a server does once and keeps: kernels compiled, the viewer's files laid out, the index of the runs made."""
    command = [sys.executable, "-c", WARM_UP, str(folder / "runs")]
    subprocess.run(command, stdin=subprocess.DEVNULL, env=_environment(folder), check=True)


def _environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}


@contextlib.contextmanager
def serving(folder: Path) -> Iterator[Serving]:
    """`workbench serve` in a process of its own, with runs and cache in a folder.

    Raises:
        BenchError: it did not start.
    """
    log = folder / "serve.log"
    command = [sys.executable, "-m", "workbench", "serve", "--port", "0", "--no-browser"]
    with log.open("w") as file:
        process = subprocess.Popen(
            [*command, "--runs", str(folder / "runs")],
            stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=_environment(folder),
        )  # fmt: skip
    try:
        yield Serving(_await_address(process, log), process.pid)
    finally:
        process.terminate()
        try:
            process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()


def _await_address(process: subprocess.Popen[bytes], log: Path) -> str:
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline and process.poll() is None:
        if found := ADDRESS.search(log.read_text()):
            return found[0]
        time.sleep(0.02)
    last = (log.read_text().strip().splitlines() or ["it said nothing"])[-1]
    raise BenchError(f"the server that was to be measured did not start: {last}")


@contextlib.contextmanager
def browsing(chromium: Path) -> Iterator[Page]:
    """A page of a headless browser with nothing in its cache.

    Raises:
        BenchError: whatever the browser could not do within a minute.
    """
    from playwright.sync_api import Error, sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=str(chromium), args=headless_flags())
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.set_default_timeout(1000.0 * PATIENCE_S)
        try:
            yield page
        except Error as error:
            where = page.url.partition("?")[0]
            raise BenchError(f"the pages could not be measured at {where}: {error.message.splitlines()[0]}") from error
        finally:
            browser.close()
