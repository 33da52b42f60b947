"""Do the server and the browser grow while pages are opened and left, as they are over a long day?"""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil

from workbench.bench.page import SETTLED, Progress, Serving, browsing, ensure_browser, serving
from workbench.bench.runs import make_runs

if TYPE_CHECKING:
    from playwright.sync_api import Page

RUNS = 50
READY = {
    "fly": ".card.exit, .card.failed",
    "curriculum": ".stage",
    "live": "[aria-label=Trainings]",
    "runs": ".sheet .row",
    "compare": ".legend .swatch",
    "paper": "[data-verdict]",
}
"""What stands on each page once it has been filled."""
WARM_UP = 60
"""Openings before the first look: caches fill, and every page is imported."""
FORGET_S = 40.0
"""Longer than Panel keeps a session whose page was left."""
BLANK = "about:blank"
MEBIBYTE = 2.0**20


@dataclass(frozen=True)
class Openings:
    """What `workbench bench page --openings N` measures."""

    openings: int
    before_mib: float
    """Resident memory of the server, after the warm-up and once its pages were left."""
    after_mib: float
    """The same after the openings."""
    growth_mib_per_100: float
    tab_before_mib: float
    """What the scripts of the tab hold while Paper stands, after the warm-up."""
    tab_after_mib: float
    """The same after the openings."""
    tab_growth_mib_per_100: float


def bench_openings(openings: int, warm_up: int = WARM_UP, progress: Progress | None = None) -> Openings:
    """Open all pages in turn, `openings` times in all, and read how much memory the server holds.

    Raises:
        BenchError: Playwright or Chromium is missing, or the server did not start.
    """
    chromium = ensure_browser()
    tell = progress or (lambda done, total: None)
    total = warm_up + openings
    with tempfile.TemporaryDirectory(prefix="workbench-bench-") as folder:
        make_runs(Path(folder) / "runs", RUNS)
        with serving(Path(folder)) as server, browsing(chromium) as page:
            for number in range(warm_up):
                _open(page, server, number)
                tell(number + 1, total)
            before = _held(page, server)
            for number in range(openings):
                _open(page, server, number)
                tell(warm_up + number + 1, total)
            after = _held(page, server)
    hundreds = max(openings, 1) / 100.0
    server_grew, tab_grew = ((then - now) / hundreds for now, then in zip(before, after, strict=True))
    return Openings(openings, before[0], after[0], server_grew, before[1], after[1], tab_grew)


def _open(page: Page, server: Serving, number: int) -> None:
    """By the links, in one tab, as a person would; the first of all by its address."""
    name = list(READY)[number % len(READY)]
    if page.url == BLANK:
        page.goto(server.link.replace("/?", f"/{name}?"))
    else:
        page.locator(f"nav[aria-label=Pages] a[href^='/{name}']").click()
        page.wait_for_url(f"**/{name}**")
    page.locator(READY[name]).first.wait_for()
    page.wait_for_function(SETTLED)


def _held(page: Page, server: Serving) -> tuple[float, float]:
    """MiB: of the server without its children, once it has forgotten the pages; of the tab's scripts, before."""
    _open(page, server, len(READY) - 1)
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    tab = float(session.send("Runtime.getHeapUsage")["usedSize"])
    session.detach()
    page.goto(BLANK)
    time.sleep(FORGET_S)
    return float(psutil.Process(server.pid).memory_info().rss) / MEBIBYTE, tab / MEBIBYTE
