"""A person masks missiles, orders the chain by hand and by keyboard, sees what it costs and launches it."""

from __future__ import annotations

import os
import re
import time

import pytest
from playwright.sync_api import Locator, Page, expect

from agents.config import TrainingConfig
from tests.browser.places import box_of
from tests.conftest import Served
from workbench.launcher import cpu_count
from workbench.run_state import RunState
from workbench.runs import RunStore

NODE = """mask => {
  const views = [...Bokeh.index.roots], nodes = ({data_source}) => data_source?.data?.mask
  for (let view; (view = views.pop());) {
    const renderer = view.model.renderers?.find(nodes)
    if (!renderer) { views.push(...view.children_views()); continue }
    const {x, y, mask: masks} = renderer.data_source.data, at = [...masks].indexOf(mask)
    const {left, top} = view.el.getBoundingClientRect()
    return [left + view.frame.x_scale.compute(x[at]), top + view.frame.y_scale.compute(y[at])]
  }
}"""
"""Where the lattice shows the task with this mask [px]."""


@pytest.fixture
def store(workbench: Served) -> RunStore:
    return RunStore(workbench.runs)


def _stages(page: Page) -> Locator:
    return page.get_by_role("list", name="Stages in the order they are trained").get_by_role("button")


def _open(page: Page, workbench: Served, query: str = "") -> None:
    page.goto(f"{workbench.address}/curriculum{query}")
    expect(page.get_by_role("button", name="Launch")).to_be_enabled()


def test_everything_follows_a_masked_missile(person: Page, workbench: Served) -> None:
    _open(person, workbench)
    expect(person.get_by_text("Target task", exact=True).first).to_be_visible()
    expect(_stages(person)).to_have_count(4)
    person.get_by_role("button", name="Missile 2", exact=True).click()
    expect(person.get_by_text("Missiles 1, 3, 4", exact=True).first).to_be_visible()
    expect(person.get_by_text("13 of 15 numbers")).to_be_visible()
    expect(person.locator(".chip.gone")).to_have_count(3)  # r, φ and the reward term
    expect(_stages(person)).to_have_count(3)
    person.wait_for_url("**mask=2**")
    person.reload()
    expect(person.get_by_text("Missiles 1, 3, 4", exact=True).first).to_be_visible()


def test_a_task_is_chosen_in_the_picture_of_all_of_them(person: Page, workbench: Served) -> None:
    _open(person, workbench)
    expect(_stages(person)).to_have_count(4)
    box_of(person.locator(".bk-Figure").first)
    person.mouse.click(*person.evaluate(NODE, "1,3"))
    expect(person.get_by_text("Missiles 2, 4", exact=True).first).to_be_visible()
    expect(_stages(person)).to_have_count(2)
    for number, pressed in ((1, "false"), (2, "true")):  # pressed: it flies
        missile = person.get_by_role("button", name=f"Missile {number}", exact=True)
        expect(missile).to_have_attribute("aria-pressed", pressed)
    person.wait_for_url("**mask=1%2C3**")


def test_the_order_is_changed_by_drag_and_by_keyboard(person: Page, workbench: Served) -> None:
    _open(person, workbench)
    first, last = _stages(person).first, _stages(person).last
    expect(first).to_have_accessible_name("Stage 1 of 4: Source task 3, missile 1 is new, guide: Navigation (expert). "
                                          "Arrow keys move it.")  # fmt: skip
    _drag(person, first, last)
    expect(_stages(person).last).to_have_accessible_name(_says("Stage 4 of 4: Target task, missile 1 is new"))
    expect(_stages(person).first).to_have_accessible_name(_says("Stage 1 of 4: Missile 2, missile 2 is new"))
    person.wait_for_url("**order=1%2C4%2C3%2C2**")
    expect(person.get_by_text("τ = 1, 4, 3, 2")).to_be_visible()
    moved = _stages(person).nth(3)
    moved.focus()
    moved.press("ArrowLeft")
    expect(_stages(person).nth(2)).to_have_accessible_name(_says("missile 1 is new"))
    expect(_stages(person).nth(2)).to_be_focused()
    person.wait_for_url("**order=4%2C1%2C3%2C2**")
    person.reload()
    expect(_stages(person).nth(2)).to_have_accessible_name(_says("missile 1 is new"))
    person.get_by_role("button", name="Back to Table 1's order").click()
    expect(_stages(person).first).to_have_accessible_name(_says("Source task 3"))


def _says(words: str) -> re.Pattern[str]:
    return re.compile(re.escape(words))


def _drag(page: Page, what: Locator, where: Locator) -> None:
    start, end = box_of(what), box_of(where)
    page.mouse.move(start["x"] + 20, start["y"] + 20)
    page.mouse.down()
    page.mouse.move(start["x"] + 60, start["y"] + 25, steps=3)
    page.mouse.move(end["x"] + end["width"] - 20, end["y"] + 25, steps=12)
    page.mouse.up()


def test_variants_times_seeds_are_queued_and_watched_from_here(
    person: Page, workbench: Served, store: RunStore
) -> None:
    # As many runs that seem to be alive as would fill every core: what is launched only waits.
    blockers = [store.create(TrainingConfig(profile="smoke", name=f"busy {number}")) for number in range(cpu_count())]
    locks = [run.claim() for run in blockers]
    for run in blockers:
        run.write_state(RunState("running"))
    _open(person, workbench, "?mask=4&profile=smoke")
    person.get_by_label("Seeds: 0 or 0,1,2 or 0-4").fill("5,6")
    person.get_by_label("Seeds: 0 or 0,1,2 or 0-4").press("Enter")
    person.get_by_role("button", name="W/o-PD").click()
    expect(person.get_by_text("2 variants × 2 seeds")).to_be_visible()
    person.get_by_role("button", name="Launch 4 runs").click()
    lines = person.get_by_role("listitem").filter(has_text="queued")
    expect(lines).to_have_count(4)
    launched = [run for run in store.list() if run not in blockers]
    assert {(run.config.variant, run.config.seed, run.config.mask) for run in launched} == {
        (variant, seed, "4") for variant in ("submas", "wo-pd") for seed in (5, 6)
    }
    address = lines.first.get_by_role("link", name="Watch").get_attribute("href") or ""
    shown = next(run for run in launched if address == f"/live?run={run.id}")
    shown.request_stop()
    expect(person.get_by_text("■ stopped")).to_be_visible()
    for run in launched:
        if run is not shown:
            run.request_stop()
    for run, lock in zip(blockers, locks, strict=True):
        run.write_state(RunState("stopped"))
        assert lock is not None
        os.close(lock)
        store.delete(run.id)


@pytest.mark.slow
def test_a_stage_is_launched_watched_and_stopped(person: Page, workbench: Served, store: RunStore) -> None:
    person.goto(f"{workbench.address}/curriculum?what=stage&mask=3,4")
    expect(person.get_by_text("Source task 2", exact=True).first).to_be_visible()
    person.get_by_role("button", name="Missile 2", exact=True).click()
    expect(person.get_by_text("Source task 3", exact=True).first).to_be_visible()
    expect(person.get_by_text("guide: Navigation (expert)")).to_be_visible()
    person.get_by_role("button", name="Launch").click()
    person.wait_for_url("**/live?run=*")
    run = next(run for run in store.list() if run.id in person.url)
    assert run.config == TrainingConfig(missiles=1)
    expect(person.get_by_text("running", exact=True)).to_be_visible()
    person.get_by_role("button", name="Stop", exact=True).click()
    person.get_by_role("button", name="Stop this run").click()
    expect(person.get_by_text("Stopping …")).to_be_visible()
    assert run.stop_requested()
    deadline = time.monotonic() + 240
    while run.state.active and time.monotonic() < deadline:
        time.sleep(0.5)
    assert run.state.state == "stopped"
    expect(person.get_by_text("stopped", exact=True)).to_be_visible()


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (2560, 1200)])
def test_nothing_sticks_out_of_a_narrow_or_a_wide_window(
    width: int, height: int, person: Page, workbench: Served
) -> None:
    person.set_viewport_size({"width": width, "height": height})
    _open(person, workbench, "?scenario=six-missiles&order=1,2,3,4,5,6&theme=default")
    expect(_stages(person)).to_have_count(6)
    for part in (_stages(person).first, _stages(person).last, person.get_by_role("button", name="Launch")):
        box = box_of(part)
        assert box["x"] >= 0 and box["x"] + box["width"] <= width
    assert person.evaluate("document.scrollingElement.scrollWidth <= innerWidth")
