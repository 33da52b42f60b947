"""Does the server grow while pages are opened and left, as they are over a long day?"""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil

from workbench.bench.page import Progress, browsing, ensure_browser, serving
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
            page.goto(server.link)
            for number in range(warm_up):
                _open(page, server.link, number)
                tell(number + 1, total)
            before = _resident(page, server.pid)
            for number in range(openings):
                _open(page, server.link, number)
                tell(warm_up + number + 1, total)
            after = _resident(page, server.pid)
    growth = 100.0 * (after - before) / max(openings, 1)
    return Openings(openings, before / MEBIBYTE, after / MEBIBYTE, growth / MEBIBYTE)


def _open(page: Page, link: str, number: int) -> None:
    name = list(READY)[number % len(READY)]
    page.goto(link.partition("?")[0] + name)
    page.locator(READY[name]).first.wait_for()


def _resident(page: Page, pid: int) -> float:
    """Resident bytes of the server without its children, once it has forgotten the pages that were left."""
    page.goto("about:blank")
    time.sleep(FORGET_S)
    return float(psutil.Process(pid).memory_info().rss)
