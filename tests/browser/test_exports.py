"""Files that a browser opens or saves: the replay from a disk, with the network gone, and figures as drawings."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path

import av
import pytest
from bokeh.embed import file_html
from bokeh.resources import INLINE
from PIL import Image
from playwright.sync_api import Page, Route, expect

from layouts.azimuth import azimuth_chart
from sim.world import Outcome
from tests.conftest import Served
from tests.workbench.flights import ending
from workbench.branch import Branch
from workbench.branch_text import branch_text
from workbench.exports import export

SLOW_MS = 180_000


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


def _chosen(visitor: Page, entry: str, folder: Path) -> Path:
    """The file that an entry of the export menu saves."""
    visitor.locator(".export > button").click()
    with visitor.expect_download(timeout=SLOW_MS) as download:
        visitor.get_by_role("menuitem", name=entry).click()
    path = folder / download.value.suggested_filename
    download.value.save_as(path)
    return path


def test_a_page_hands_out_its_flights_with_the_branch_and_a_picture_of_the_scene(
    visitor: Page, served: Served, tmp_path: Path
) -> None:
    branch = Branch("B", 330, (200,) * 40 + (170,) * 20, "submas-target")
    visitor.goto(f"{served.address}/fly?seed=2&t=360&branch={branch_text(branch)}")
    expect(visitor.locator(".card.branch")).to_be_visible()
    visitor.locator(".export > button").click()
    offered = visitor.get_by_role("menu").inner_text()
    assert all(kind in offered for kind in ("html", "gif", "mp4", "rrd", "acmi", "parquet", "csv", "png", "svg"))
    visitor.keyboard.press("Escape")
    table = _chosen(visitor, "B′ · csv", tmp_path)
    assert table.name == "flight-2-B-from-330s-by-hand-then-submas-target.csv"
    assert table.read_bytes().startswith(b"time_s,evader_x_m,")
    with Image.open(_chosen(visitor, "gif Animation", tmp_path)) as animation:
        assert animation.n_frames > 100  # pyright: ignore[reportAttributeAccessIssue]
        assert b"from 330 s by hand, then submas-target" in animation.info["comment"]
    replay = _chosen(visitor, "html Replay", tmp_path)
    expect(visitor.locator(".cover.gone")).to_have_count(1)
    with visitor.expect_download(timeout=SLOW_MS) as download:
        visitor.get_by_role("button", name="PNG", exact=True).click()
    with Image.open(download.value.path()) as picture:
        assert (picture.format, picture.width) == ("PNG", 1920)
        assert len(picture.convert("RGB").getcolors(maxcolors=10**7) or []) > 100
    expect(visitor.get_by_role("button", name="PNG", exact=True)).to_be_visible()
    asked: list[str] = []
    visitor.on("request", lambda request: asked.append(request.url))
    visitor.context.set_offline(True)
    visitor.goto(f"{replay.as_uri()}#t=360")
    expect(visitor.get_by_role("heading", name="B′ · from 5:30 by hand, then submas-target")).to_be_visible()
    visitor.get_by_role("button", name=re.compile("handed over to submas-target")).click()
    expect(visitor.locator("#now")).to_have_text("6:30")
    before = visitor.locator("#scene").screenshot()
    visitor.get_by_role("button", name="Follow B′").click()
    visitor.get_by_role("button", name="Play or pause").click()
    expect(visitor.locator("#now")).not_to_have_text("6:30")
    assert visitor.locator("#scene").screenshot() != before
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:"))] == []


def test_a_page_hands_out_a_film_of_both_flights(visitor: Page, served: Served, tmp_path: Path) -> None:
    visitor.goto(f"{served.address}/fly?seed=2&a=random&b=expert-dragging")
    expect(visitor.locator(".card.exit, .card.failed")).to_have_count(2)
    film = _chosen(visitor, "mp4 Film", tmp_path)
    with av.open(film) as container:
        (stream,) = container.streams
        assert stream.codec_context.name == "h264"
        assert stream.frames > 100
        assert all(words in container.metadata["title"] for words in ("random", "expert-dragging"))


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
