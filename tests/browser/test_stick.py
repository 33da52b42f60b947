"""Take the stick: another policy flies on, or the person; the branch is beside the original and in the address."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from tests.conftest import Served

SLOW_MS = 120_000


def _open(visitor: Page, served: Served, query: str) -> None:
    expect.set_options(timeout=SLOW_MS)
    visitor.set_default_timeout(SLOW_MS)
    visitor.goto(f"{served.address}/fly{query}")
    expect(visitor.locator(".card.exit, .card.failed").nth(1)).to_be_visible()


def test_the_other_policy_flies_on_and_a_reload_shows_the_same_branch(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&t=330")
    expect(visitor.get_by_text("from 5:30 on")).to_be_visible()
    visitor.get_by_role("button", name="B", exact=True).click()
    visitor.get_by_role("button", name="Fly on").click()
    branch = visitor.locator(".card.branch")
    expect(branch).to_be_visible()
    expect(branch).to_contain_text("from 5:30 SubMas-RL, target task (shipped)")
    expect(branch).to_contain_text("B: ✗ Shot down by missile 3")
    expect(visitor.locator(".events .who", has_text="B′").first).to_be_visible()
    expect(visitor.locator(".events .what", has_text="leaves B: submas-target")).to_be_visible()
    compared = visitor.locator(".take-the-stick .bk-Figure")
    expect(compared).to_have_count(3)
    expect(visitor).to_have_url(re.compile("branch=B%2C330%2Csubmas-target"))
    told = branch.inner_text()
    visitor.reload()
    expect(branch).to_be_visible()
    assert branch.inner_text() == told
    visitor.get_by_role("button", name="Back to the original").click()
    expect(branch).to_be_hidden()
    expect(compared.first).to_be_hidden()
    expect(visitor).not_to_have_url(re.compile("branch="))
    expect(visitor.locator(".events .who", has_text="B′")).to_have_count(0)


def test_a_person_steers_by_keys_and_mouse_and_hands_over(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&t=100")
    visitor.get_by_role("button", name="I fly").click()
    dial = visitor.get_by_role("slider", name="Heading to fly")
    expect(dial).to_be_visible()
    visitor.get_by_role("button", name="1×", exact=True).last.click()
    before = int(dial.get_attribute("aria-valuenow") or "0")
    visitor.keyboard.down("ArrowLeft")
    expect(dial).not_to_have_attribute("aria-valuenow", str(before))
    visitor.keyboard.up("ArrowLeft")
    left = (int(dial.get_attribute("aria-valuenow") or "0") - before) % 360
    assert 0 < left <= 180
    # The clock's own arrow keys are the dial's for now: time goes on by flying alone, and the aircraft has turned.
    expect(visitor.locator(".stick dd").nth(1)).not_to_have_text(f"{before}°")
    dial.click(position={"x": 104, "y": 20})
    expect(dial).to_have_attribute("aria-valuenow", re.compile("^(8[5-9]|9[0-5])$"))
    visitor.keyboard.press("Space")
    expect(visitor.get_by_role("button", name="Go on")).to_be_visible()
    expect(visitor).to_have_url(re.compile("branch=A%2C100%2Cby-hand."))
    visitor.get_by_role("button", name="Hand over").click()
    branch = visitor.locator(".card.branch")
    expect(branch).to_be_visible()
    expect(branch).to_contain_text(re.compile(r"from 1:40 by hand, from \d+:\d\d SubMas-RL, target task"))
    told, where = branch.inner_text(), visitor.url
    assert re.search(r"by-hand\.[\w-]+%2Csubmas-target", where)
    visitor.reload()
    expect(branch).to_be_visible()
    assert branch.inner_text() == told


def test_a_damaged_branch_is_one_sentence(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&branch=A,5,by-hand.%3Cscript%3E")
    expect(visitor.get_by_text("are not base64 of byte pairs")).to_be_visible()
    expect(visitor.get_by_text("No branch is flown.")).to_be_visible()
    expect(visitor).not_to_have_url(re.compile("branch="))
