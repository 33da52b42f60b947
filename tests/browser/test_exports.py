"""Files that a browser opens or saves: the replay from a disk, with the network gone, and figures as drawings."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

import pytest
from bokeh.embed import file_html
from bokeh.resources import INLINE
from playwright.sync_api import Page, Route, expect

from layouts.azimuth import azimuth_chart
from sim.world import Outcome
from tests.workbench.flights import ending
from workbench.exports import export

SLOW_MS = 60_000


@pytest.fixture
def asked(page: Page) -> Iterator[list[str]]:
    """Addresses other than files that the page asked for; none of them is answered."""
    found: list[str] = []

    def refuse(route: Route) -> None:
        found.append(route.request.url)
        route.abort()

    page.route(re.compile(r"^(?!file:|blob:|data:)"), refuse)
    page.context.set_offline(True)
    page.set_default_timeout(SLOW_MS)
    expect.set_options(timeout=SLOW_MS)
    yield found


@pytest.fixture
def replay(tmp_path: Path) -> Path:
    path = tmp_path / "both.html"
    export(ending(Outcome.EXIT), path, ending(Outcome.SHOT_DOWN))
    return path


def test_the_replay_plays_from_a_disk_and_asks_nobody(
    page: Page, replay: Path, asked: list[str], complaints: list[str]
) -> None:
    page.goto(replay.as_uri())
    now, rail = page.locator("#now"), page.locator("#rail")
    expect(now).to_have_text("0:00")
    before = page.locator("#scene").screenshot()
    page.get_by_role("button", name="Play or pause").click()
    expect(now).not_to_have_text("0:00")
    page.keyboard.press("Tab")
    page.get_by_role("button", name="Play or pause").click()
    assert float(rail.input_value()) > 0.0
    page.get_by_role("button", name=re.compile("B missile 1 launched")).click()
    launched_s = ending(Outcome.SHOT_DOWN).events[0].time_s
    page.wait_for_function("(time) => Math.abs(document.getElementById('rail').value - time) < 0.06", arg=launched_s)
    assert page.locator("#scene").screenshot() != before
    assert asked == []


def test_the_replay_is_moved_by_curve_keys_and_cameras(
    page: Page, replay: Path, asked: list[str], complaints: list[str]
) -> None:
    page.goto(f"{replay.as_uri()}#t=30&camera=follow")
    expect(page.locator("#now")).to_have_text("0:30")
    expect(page.get_by_role("button", name="Follow")).to_have_attribute("aria-pressed", "true")
    page.keyboard.press("Shift+ArrowRight")
    expect(page.locator("#now")).to_have_text("0:40")
    page.locator("#plots canvas").first.click(position={"x": 60, "y": 60})
    expect(page.locator("#now")).not_to_have_text("0:40")
    for camera in ("Top", "Free", "Overview"):
        page.get_by_role("button", name=camera).click()
        expect(page.get_by_role("button", name=camera)).to_have_attribute("aria-pressed", "true")
    page.get_by_role("button", name="About").click()
    expect(page.get_by_role("dialog")).to_contain_text(ending(Outcome.EXIT).task.scenario.digest)
    assert asked == []


def test_even_a_changed_replay_may_ask_nobody_and_without_its_policy_it_would(
    page: Page, replay: Path, asked: list[str]
) -> None:
    """A picture from elsewhere put into the file: the policy inside refuses it; without the policy it is asked for."""
    text = replay.read_text("utf-8").replace("<main>", '<main><img src="http://example.org/a.png">')
    replay.write_text(text, "utf-8")
    page.goto(replay.as_uri())
    expect(page.locator("#now")).to_have_text("0:00")
    page.wait_for_timeout(300)
    assert asked == []
    replay.write_text(re.sub(r"<meta http-equiv[^>]*>", "", text), "utf-8")
    page.goto(replay.as_uri())
    expect(page.locator("#now")).to_have_text("0:00")
    page.wait_for_timeout(300)
    assert asked == ["http://example.org/a.png"]


def test_a_figure_is_saved_as_picture_drawing_and_numbers(page: Page, tmp_path: Path, complaints: list[str]) -> None:
    chart = azimuth_chart(range(1, 5))
    chart.show(ending(Outcome.EXIT), "A")
    path = tmp_path / "figure.html"
    # Bokeh adds scripts and styles of every component that any other test has imported; a figure needs none of them.
    foreign = r"<script[^>]* src=[^>]*></script>|<link[^>]* href=[^>]*>"
    path.write_text(re.sub(foreign, "", file_html(chart.figure, INLINE)), "utf-8")
    page.goto(path.as_uri())
    page.locator(".bk-Figure").first.hover()
    saved = {}
    for kind in ("PNG", "SVG", "CSV"):
        with page.expect_download(timeout=SLOW_MS) as download:
            page.locator(f"[title='Download {kind}']").click()
        assert download.value.suggested_filename == f"azimuth.{kind.lower()}"
        saved[kind] = Path(download.value.path()).read_bytes()
    assert saved["PNG"].startswith(b"\x89PNG")
    drawing = ElementTree.fromstring(saved["SVG"])
    words = " ".join(node.text or "" for node in drawing.iter("{http://www.w3.org/2000/svg}text"))
    assert "azimuth [deg]" in words
    assert "missile 4" in words
    assert len(list(drawing.iter("{http://www.w3.org/2000/svg}path"))) > 10
    assert saved["CSV"].splitlines()[0].startswith(b"time_s,missile_1_deg,")
