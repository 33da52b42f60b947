"""The Fly page as a person uses it."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from layouts.theme import ground
from tests.browser.places import box_of
from tests.conftest import Served

CAMERA_MS = 1500
"""A camera's way, drawn by software."""
SLOW_MS = 90_000


def _open(visitor: Page, served: Served, query: str = "") -> None:
    visitor.goto(f"{served.address}/fly{query}")
    expect(visitor.locator(".card.exit, .card.failed")).to_have_count(2, timeout=SLOW_MS)


def test_both_flights_are_told_of_and_drawn_as_wished(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=7")
    expect(visitor.locator(".events button").first).to_be_visible()
    expect(visitor.locator(".cover.gone")).to_have_count(1, timeout=SLOW_MS)
    assert "seed=7" in visitor.url
    for name in ("Labels", "Trails", "Sight", "±90°", "Energy"):
        visitor.get_by_role("button", name=name, exact=True).click()
    expect(visitor).to_have_url(re.compile("hide=labels%2Ctrails%2Csight%2Cbeams.*show=energy"), timeout=SLOW_MS)
    box = visitor.locator("iframe[title^='3-D replay']").bounding_box()
    assert box is not None
    visitor.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    visitor.mouse.down()
    visitor.mouse.move(box["x"] + box["width"] / 2 + 90, box["y"] + box["height"] / 2 + 20, steps=4)
    visitor.mouse.up()
    expect(visitor.get_by_role("button", name="Free", exact=True)).to_have_attribute("aria-pressed", "true")
    expect(visitor).to_have_url(re.compile("camera=free.*eye=-?[0-9]"), timeout=SLOW_MS)


def test_every_camera_looks_from_elsewhere_and_every_speed_is_kept(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&t=360")
    expect(visitor.locator(".cover.gone")).to_have_count(1, timeout=SLOW_MS)
    scene = visitor.locator("iframe[title^='3-D replay']")
    seen = [scene.screenshot()]
    for camera in ("Top", "Chase A", "Chase B", "One field"):
        button = visitor.get_by_role("button", name=camera, exact=True)
        button.click()
        expect(button).to_have_attribute("aria-pressed", "true")
        visitor.wait_for_timeout(CAMERA_MS)
        seen.append(scene.screenshot())
    assert len(set(seen)) == len(seen)
    visitor.get_by_role("group", name="Playback speed").get_by_role("button", name="60×").click()
    expect(visitor).to_have_url(re.compile("speed=60"), timeout=SLOW_MS)


def test_the_scene_stands_on_the_ground_of_a_light_page(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?theme=default")
    expect(visitor.locator(".cover.gone")).to_have_count(1, timeout=SLOW_MS)
    scene = next(frame for frame in visitor.frames if "/viser/" in frame.url)
    behind = scene.locator("canvas").last.evaluate("""canvas => {
      const colours = []
      for (let at = canvas; at; at = at.parentElement) { colours.push(getComputedStyle(at).backgroundColor) }
      return colours.find(colour => colour !== "rgba(0, 0, 0, 0)")
    }""")
    assert behind == "rgb({}, {}, {})".format(*ground("light").background)  # viser's own is dark


def test_an_event_moves_the_clock_and_the_address(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=7")
    row = visitor.locator(".events button.launch").first
    when = row.locator(".when").inner_text()
    row.click()
    expect(visitor.locator(".clock .now")).to_have_text(when)
    expect(visitor).to_have_url(re.compile(r"[?&]t=[1-9]"), timeout=SLOW_MS)


def test_masking_a_missile_flies_again_and_changes_the_address(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=7")
    visitor.get_by_role("button", name="Missile 4", exact=True).click()
    expect(visitor.locator(".card", has_text="of 3")).to_have_count(2, timeout=SLOW_MS)
    expect(visitor).to_have_url(re.compile("mask=4"), timeout=SLOW_MS)


def test_a_wrong_address_is_one_sentence_and_flies_anyway(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?a=<b>nobody</b>&seed=x")
    expect(visitor.get_by_text("Policy '<b>nobody</b>' is not known here")).to_be_visible()
    expect(visitor.get_by_text("Seed 'x' is not a whole number")).to_be_visible()


def test_playing_moves_the_clock_and_a_pause_holds_it(visitor: Page, served: Served) -> None:
    _open(visitor, served)
    now, speed = visitor.locator(".clock .now"), visitor.get_by_role("group", name="Playback speed")
    visitor.get_by_role("button", name="Play or pause").click()
    expect(now).not_to_have_text("0:00", timeout=SLOW_MS)
    speed.get_by_role("button", name="10×").click()
    visitor.keyboard.press("Space")
    stopped = now.inner_text()
    expect(visitor).to_have_url(re.compile("speed=10"), timeout=SLOW_MS)
    expect(now).to_have_text(stopped)


def test_keys_and_buttons_step_and_leap_and_the_sheet_tells_of_them(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=7&t=100")
    now = visitor.locator(".clock .now")
    expect(now).to_have_text("1:40")
    visitor.keyboard.press("ArrowRight")
    expect(now).to_have_text("1:41")
    visitor.get_by_role("button", name="One step back").click()
    expect(now).to_have_text("1:40")
    visitor.keyboard.press("Shift+ArrowRight")
    expect(now).to_have_text("1:50")
    first = visitor.locator(".events .when").first.inner_text()
    visitor.keyboard.press("]")
    expect(now).to_have_text(first)
    visitor.keyboard.press("?")
    sheet = visitor.get_by_role("dialog", name="Keys and symbols")
    expect(sheet.get_by_text("one decision step (1 s) back, on")).to_be_visible()
    visitor.keyboard.press("ArrowRight")
    expect(now).to_have_text(first)
    visitor.keyboard.press("Escape")
    expect(sheet).to_be_hidden()


def test_the_read_outs_follow_the_clock_and_tell_where_transfer_is_prevented(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&t=100")
    mine = visitor.get_by_role("region", name="Read-outs of flight A")
    expect(mine).to_contain_text("transfer allowed")
    expect(visitor.get_by_role("region", name="Read-outs of flight B")).not_to_contain_text("transfer")
    of_a = visitor.locator(".who", has_text=re.compile("^A$"))
    visitor.locator(".events button.launch", has_text="missile 4").filter(has=of_a).click()
    for _ in range(2):
        visitor.keyboard.press("ArrowRight")
    expect(mine).to_contain_text("transfer prevented")
    expect(mine.locator(".line.flying .closure").first).to_contain_text("m/s")
    visitor.get_by_role("button", name="Read-outs", exact=True).click()
    expect(mine).to_be_hidden()
    expect(visitor).to_have_url(re.compile("hide=readouts"), timeout=SLOW_MS)


def test_a_curve_sets_the_clock_and_both_flights_share_a_figure_if_wished(visitor: Page, served: Served) -> None:
    _open(visitor, served, "?seed=2&curves=over&camera=top")
    figures = visitor.locator(".bk-Figure")
    expect(figures).to_have_count(1)
    expect(visitor.get_by_role("button", name="Top", exact=True)).to_have_attribute("aria-pressed", "true")
    figures.first.scroll_into_view_if_needed()
    box = box_of(figures.first)
    place = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    visitor.mouse.click(*place)
    now = visitor.locator(".clock .now")
    expect(now).not_to_have_text("0:00")
    # The clock's line stands where the curve was clicked.
    line = box_of(figures.first.locator("i[aria-hidden]").first)
    assert abs(line["x"] - place[0]) < 3
    visitor.get_by_role("button", name="Side by side").click()
    expect(figures).to_have_count(2)
    expect(visitor).not_to_have_url(re.compile("curves="), timeout=SLOW_MS)
    visitor.locator("body").press("c")
    expect(visitor).to_have_url(re.compile("camera=chase-a"), timeout=SLOW_MS)
    visitor.reload()
    expect(visitor.locator(".card.exit, .card.failed")).to_have_count(2, timeout=SLOW_MS)
    expect(visitor.get_by_role("button", name="Chase A")).to_have_attribute("aria-pressed", "true")


def test_every_kind_of_curve_is_drawn_and_can_be_taken_home(visitor: Page, served: Served) -> None:
    _open(visitor, served)
    for tab, figures in (("Control", 6), ("Speed", 4), ("Reward", 2), ("Range", 4), ("Azimuth", 2)):
        visitor.get_by_role("tab", name=tab).click()
        expect(visitor.locator(".bk-Figure:visible")).to_have_count(figures, timeout=SLOW_MS)
    visitor.locator(".bk-Figure").first.hover()
    with visitor.expect_download(timeout=SLOW_MS) as download:
        visitor.locator("[title='Download CSV']").first.click()
    assert download.value.suggested_filename == "azimuth.csv"


def test_six_missiles_are_flown_with_the_mask_that_the_page_offers(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/fly?scenario=six-missiles")
    offer = visitor.get_by_role("button", name="Mask 5, 6 and fly")
    expect(offer).to_be_visible(timeout=SLOW_MS)
    expect(visitor.get_by_text("cannot see missiles 5, 6 of this task")).to_be_visible()
    offer.click()
    expect(visitor.locator(".card.exit, .card.failed")).to_have_count(2, timeout=SLOW_MS)
    expect(visitor.get_by_text("was trained on scenario 'default'")).to_be_visible()
    expect(visitor.get_by_role("button", name="Missile 6")).to_have_attribute("aria-pressed", "false")
    expect(visitor).to_have_url(re.compile(r"scenario=six-missiles.*mask=5%2C6"))
