"""The Compare page as a person uses it."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from agents.evaluation import evaluate
from sim.task import task_for
from tests.browser.places import box_of
from tests.conftest import Served
from workbench.policies import resolve_policy

SLOW_MS = 240_000
PAIR = "policies=expert-dragging,expert-navigation&tasks=source-3&episodes=40&seed=5"
"""Rules on one missile: forty engagements take a second."""


@pytest.fixture
def comparing(visitor: Page, served: Served) -> Iterator[Page]:
    """The two rules compared; their engagements fly of their own accord."""
    visitor.set_default_timeout(SLOW_MS)
    visitor.goto(f"{served.address}/compare?{PAIR}")
    expect(visitor.locator("a.shot").first).to_be_visible(timeout=SLOW_MS)
    yield visitor


def test_a_first_visitor_sees_fig_13_and_where_it_comes_from(person: Page, workbench: Served) -> None:
    visitor = person  # of a server where nobody has compared anything yet
    visitor.goto(f"{workbench.address}/compare")
    expect(visitor.locator(".legend")).to_contain_text("Defensive dragging (expert)", timeout=SLOW_MS)
    expect(visitor.get_by_role("button", name=re.compile(r"^Fly \d+ × 1000$"))).to_be_enabled()
    cancel = visitor.get_by_role("button", name="Cancel")
    expect(cancel).to_be_visible(timeout=SLOW_MS)  # what is looked at closely flies of its own accord
    expect(visitor.get_by_role("progressbar").first).to_be_visible()
    cancel.click()
    expect(cancel).to_be_hidden(timeout=SLOW_MS)
    expect(visitor.get_by_text("workbench reproduce fig13")).to_be_visible()
    expect(visitor.get_by_text("Closest calls and failures appear here")).to_be_visible()


def test_figures_are_those_of_the_one_evaluator(comparing: Page) -> None:
    task = task_for("default", "2,3,4")
    won = [evaluate(resolve_policy(name), task, 40, 5).results for name in ("expert-navigation", "expert-dragging")]
    assert won[0] is not None and won[1] is not None
    a, b = won[0].success, won[1].success  # the expert is what others are paired with
    counts = [int(those.sum()) for those in (a & b, a & ~b, ~a & b, ~a & ~b)]
    cells = comparing.locator("tr.close td").all_inner_texts()
    assert [int(cell) for cell in cells[2:6]] == counts
    expect(comparing.get_by_role("button", name="Nothing left to fly")).to_be_disabled()


def test_a_small_picture_flies_exactly_that_engagement(comparing: Page) -> None:
    failure = comparing.locator(".strip[data-kind=shot_down_1] a.shot").last
    episode = re.search(r"episode (\d+)", failure.inner_text())
    assert episode is not None
    failure.press("Enter")
    expect(comparing).to_have_url(re.compile(rf"/fly\?.*seed=5&episode={episode[1]}"))
    expect(comparing.locator(".card", has_text="Shot down by missile 1").first).to_be_visible(timeout=SLOW_MS)
    expect(comparing.get_by_text(f"Episode {episode[1]} of seed 5.")).to_be_visible()
    comparing.go_back()
    expect(comparing.locator("a.shot").first).to_be_visible(timeout=SLOW_MS)


def test_a_click_on_the_map_flies_that_shot(comparing: Page) -> None:
    surface = comparing.locator(".bk-Figure").nth(3)
    expect(surface).to_be_visible()
    box = box_of(surface)
    # A little in front of the nose: nobody survives that.
    surface.click(position={"x": box["width"] / 2, "y": 0.5 * box["height"] - 0.02 * box["width"]})
    expect(comparing).to_have_url(re.compile(r"/fly\?.*shot=\d+%?"), timeout=SLOW_MS)
    expect(comparing.get_by_text("One missile, fired at once from")).to_be_visible(timeout=SLOW_MS)
    expect(comparing.locator(".card", has_text="Shot down by missile 1").first).to_be_visible()


def test_the_address_holds_everything_and_reload_is_immediate(comparing: Page) -> None:
    expect(comparing).to_have_url(
        re.compile(r"policies=expert-dragging%2Cexpert-navigation&tasks=source-3.*episodes=40")
    )
    bars = comparing.locator(".bk-Figure").first
    box = box_of(bars)
    bars.click(position={"x": 0.3 * box["width"], "y": 0.75 * box["height"]})  # the left one: look at it closely
    expect(comparing).to_have_url(re.compile(r"policy=expert-dragging&against=expert-navigation"), timeout=SLOW_MS)
    before = comparing.locator("tr.close").inner_text()
    comparing.reload()
    expect(comparing.locator("tr.close")).to_have_text(before, timeout=SLOW_MS, use_inner_text=True)
    expect(comparing.get_by_role("button", name="Cancel")).to_be_hidden()


def test_tables_and_pictures_can_be_taken_home(comparing: Page, tmp_path: Path) -> None:
    for label, name in (("Engagements", "engagements.csv"), ("SVG", "comparison.svg")):
        with comparing.expect_download(timeout=SLOW_MS) as download:
            comparing.get_by_role("button", name=re.compile(f"^{label}")).click()
        assert download.value.suggested_filename == name
        download.value.save_as(tmp_path / name)
    rows = list(csv.DictReader((tmp_path / "engagements.csv").read_text().splitlines()))
    assert len(rows) == 80 and {row["outcome"] for row in rows} >= {"exit", "shot_down"}
    assert "<svg" in (tmp_path / "comparison.svg").read_text()


def test_a_wrong_address_is_told_of_and_the_rest_compared(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/compare?{PAIR.replace('expert-navigation', '<b>nobody</b>')}")
    expect(visitor.get_by_text("Policy '<b>nobody</b>' is not known here and is left out.")).to_be_visible()
    expect(visitor.locator(".legend")).to_contain_text("Defensive dragging (expert)", timeout=SLOW_MS)
