"""A page in Chromium, already let in; whatever the console complains about fails the test."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import ConsoleMessage, Page, expect

from tests.conftest import Served, start_server
from workbench.chromium import MISSING, find_chromium, headless_flags

# Telemetry and fonts that the Rerun viewer asks for and our content policy refuses; nothing else may be refused.
# The last is its own complaint of that: recordings are fetched by the page, never by the viewer.
RERUN_PHONES_HOME = ("tel.rerun.io", "api.github.com", "fonts.googleapis.com", "fonts.gstatic.com", "at __wbg_fetch_")
# What it says of itself: how its own page starts it, what the web has no windows for, and that there is no WebGPU.
RERUN_WARNS = "/rerun/"
# Chromium asks for it of its own accord, now and then before it has stored the cookie.
BY_ITSELF = "/favicon.ico"
PATIENCE_MS = 60_000
TRAINING_PATIENCE_MS = 120_000


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Everything in this folder drives a browser; in CI a story is told twice before it counts as failed.

    A page is drawn by three programs on a machine of unknown load. What fails once in fifty times is reported
    as a rerun and looked into; it keeps nobody's work from landing. At home the first failure counts.
    """
    for item in items:
        if "browser" in item.path.parts:
            item.add_marker(pytest.mark.browser)
            if os.environ.get("CI"):
                item.add_marker(pytest.mark.flaky(reruns=1))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """A first try that failed is told of in full, though the second may pass."""
    if report.outcome == "rerun":
        print(f"\nfirst try of {report.nodeid}, {report.when}:\n{report.longreprtext}")


@pytest.fixture(scope="session")
def browser_type_launch_args(browser_type_launch_args: dict[str, Any]) -> dict[str, Any]:
    """Playwright starts the Chromium that is there; without one the tests fail in CI and are skipped elsewhere."""
    chromium = find_chromium()
    if chromium is None:
        if os.environ.get("CI"):
            pytest.fail(MISSING)
        pytest.skip(MISSING)
    return {**browser_type_launch_args, "executable_path": str(chromium), "args": headless_flags()}


@pytest.fixture(scope="session")
def browser_context_args(browser_context_args: dict[str, Any]) -> dict[str, Any]:
    """The window of a laptop."""
    return {**browser_context_args, "viewport": {"width": 1440, "height": 900}}


@pytest.fixture
def complaints(page: Page) -> Iterator[list[str]]:
    """What went wrong in the page so far: errors and warnings, refused contents, failed requests."""
    found: list[str] = []

    def hear(message: ConsoleMessage) -> None:
        complaint = f"{message.text} {message.location['url']}"
        known = {"error": (*RERUN_PHONES_HOME, BY_ITSELF), "warning": (*RERUN_PHONES_HOME, RERUN_WARNS)}
        if message.type in known and not any(one in complaint for one in known[message.type]):
            found.append(complaint)

    page.on("console", hear)
    page.on("pageerror", lambda error: found.append(error.stack or str(error)))
    page.on("requestfinished", lambda request: _note_failure(found, request))
    yield found
    assert not found


def _note_failure(found: list[str], request: Any) -> None:
    reply = request.response()
    if reply is not None and reply.status >= 400:
        found.append(f"{reply.status} {request.url}")


@pytest.fixture
def visitor(page: Page, served: Served, complaints: list[str]) -> Page:
    """A page that has been let in; tests go on with `visitor.goto(served.address + "/runs")`."""
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    page.goto(f"{served.address}/healthz?token={served.token}")
    return page


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server for one module: its tests launch, stop and delete."""
    server = start_server(tmp_path_factory.mktemp("workbench"))
    yield server
    server.process.terminate()
    server.process.wait(timeout=30)


@pytest.fixture
def person(page: Page, workbench: Served, complaints: list[str]) -> Page:
    """A page that has been let in to `workbench`, with the patience that trainings need."""
    page.set_default_timeout(TRAINING_PATIENCE_MS)
    expect.set_options(timeout=TRAINING_PATIENCE_MS)
    page.goto(f"{workbench.address}/healthz?token={workbench.token}")
    return page
