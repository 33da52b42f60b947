"""A person launches, watches, pauses, resumes and flies trainings; hostile names stay text."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, Page, expect

from agents.config import TrainingConfig
from tests.browser.places import box_of
from tests.conftest import Served
from workbench.run_files import append_line
from workbench.run_state import RunState
from workbench.runs import Run, RunStore

NAMES = [
    "<img src=x onerror=window.canary=1>", "<script>window.canary=1</script>", "{{7*7}}", "${7*7}", "=HYPERLINK(1)",
    "'; DROP TABLE runs; --", "%s{0}", "../../x", "**bold**", "a" * 200,
]  # fmt: skip
"""Names people and programs could give to runs; none may do anything (S9)."""
ROW = {
    "stage": 1, "stages": 4, "task": "source-2", "missiles": [1, 2], "epochs": 100, "alpha": 0.9, "epsilon": 0.7,
    "beta": 0.1, "success_rate": 0.5, "return_mean": 12.0, "length_mean_s": 500.0, "train_success_rate": 0.4,
    "train_return_mean": 9.0, "transfer_share": 0.5, "critic_loss": 0.01, "actor_loss": -0.2, "q_mean": -3.0,
    "updates_per_s": 321.0, "env_steps_per_s": 5000.0, "eta_s": 60.0,
}  # fmt: skip
HEAR_NOTIFICATIONS = """
window.notified = [];
window.Notification = new Proxy(window.Notification, {construct(real, [title, options]) {
  window.notified.push([title, options.body]);
  return {close() {}};
}});
"""


@pytest.fixture
def store(workbench: Served) -> RunStore:
    return RunStore(workbench.runs)


class Learning:
    """A run that seems to learn: this process holds its lock and says what a training would."""

    def __init__(self, store: RunStore, name: str) -> None:
        self.run = store.create(TrainingConfig(curriculum=True, profile="fast", name=name))
        self.lock = self.run.claim()
        self.epoch = 0
        first = {"stage": 0, "task": "source-3", "epoch": 1, "env_steps": 40_960, "wall_s": 3.0}
        append_line(self.run.path / "metrics.jsonl", {**ROW, **first})
        self.learn(3)

    def learn(self, epochs: int) -> None:
        """So many epochs later."""
        for _ in range(epochs):
            self.epoch += 1
            counters = {"epoch": self.epoch, "env_steps": 40_960 * self.epoch, "wall_s": 3.0 * self.epoch}
            append_line(self.run.path / "metrics.jsonl", {**ROW, **counters})
        self.tell("running")

    def tell(self, state: str) -> None:
        """Stand like this."""
        progress = 1.0 if state == "finished" else (1 + self.epoch / 100) / 4
        stands = RunState(state, stage=1, stages=4, task="source-2", progress=progress, eta_s=60.0, wall_s=9.0)
        self.run.write_state(stands)

    def end(self, state: str) -> None:
        """End like this."""
        self.tell(state)
        if self.lock is not None:
            os.close(self.lock)
            self.lock = None


@pytest.fixture
def learning(store: RunStore) -> Iterator[Learning]:
    made = Learning(store, "the long one")
    yield made
    if made.lock is not None:
        made.end("stopped")
    store.delete(made.run.id)


def _chain(page: Page) -> Locator:
    return page.get_by_role("list", name="Stages in the order they are trained").get_by_role("listitem")


def _bar(page: Page) -> Locator:
    return page.get_by_role("progressbar", name="Progress of the whole run")


def test_nothing_under_way_says_what_to_do(person: Page, workbench: Served) -> None:
    person.goto(f"{workbench.address}/live")
    expect(person.get_by_text("Nothing is being trained")).to_be_visible()
    person.get_by_role("link", name="Launch a training").click()
    person.wait_for_url("**/curriculum")


def test_a_training_is_launched_watched_and_its_policy_flown(person: Page, workbench: Served, store: RunStore) -> None:
    person.goto(f"{workbench.address}/curriculum?what=stage&mask=2,3,4&profile=smoke")
    expect(person.get_by_text("Source task 3", exact=True).first).to_be_visible()
    person.get_by_role("button", name="Launch").click()
    person.wait_for_url("**/live?run=*")
    run = next(run for run in store.list() if run.id in person.url)
    expect(person.get_by_text("finished", exact=True)).to_be_visible()
    expect(person).to_have_title("finished · source-3 · SubMas")
    expect(_chain(person)).to_have_count(1)
    expect(_chain(person)).to_contain_text("ended: all 2 epochs done")
    expect(person.get_by_role("button", name=re.compile("^updates.s"))).to_contain_text(re.compile(r"\d"))
    person.get_by_role("link", name="Fly newest policy").click()
    person.wait_for_url(f"**/fly?a={run.id}*mask=2*3*4*")
    expect(person.locator(".card.exit, .card.failed")).to_have_count(2)
    store.delete(run.id)


def test_a_reload_in_mid_training_loses_nothing(person: Page, workbench: Served, learning: Learning) -> None:
    person.goto(f"{workbench.address}/live")
    expect(person.get_by_text("running", exact=True)).to_be_visible()
    person.wait_for_url(f"**run={learning.run.id}*")
    expect(_chain(person).nth(1)).to_have_attribute("aria-current", "step")
    expect(_chain(person).nth(1)).to_contain_text("now 50 %, 0 of 3 passed")
    person.get_by_role("radio", name="wall time").check()
    person.wait_for_url("**x=time**")
    person.get_by_role("button", name="Panels").click()
    person.get_by_role("checkbox", name="Actor loss").uncheck()
    person.keyboard.press("Escape")
    person.wait_for_url("**without=actor**")
    expect(person.get_by_role("heading", name="Actor loss")).to_be_hidden()
    learning.learn(1)
    expect(person.get_by_text("epoch 4 of at most 100")).to_be_visible()
    person.reload()
    expect(person.get_by_text("epoch 4 of at most 100")).to_be_visible()
    expect(person.get_by_role("radio", name="wall time")).to_be_checked()
    expect(person.get_by_role("heading", name="Actor loss")).to_be_hidden()
    expect(_bar(person)).to_have_attribute("aria-valuenow", "26")
    expect(person).to_have_title("26 % · source-2 · SubMas")
    person.go_back()
    expect(person.get_by_role("heading", name="Actor loss")).to_be_visible()


def test_one_moment_is_shown_by_all_panels(person: Page, workbench: Served, learning: Learning) -> None:
    person.goto(f"{workbench.address}/live?run={learning.run.id}")
    expect(person.get_by_text("Point at a curve")).to_be_visible()
    canvas = person.locator(".bk-Figure").first
    expect(canvas).to_be_visible()
    box = box_of(canvas)
    deadline = time.monotonic() + 60
    while not person.get_by_text("environment steps [million] · source-2").is_visible() and time.monotonic() < deadline:
        for share in (0.5, 0.6):
            person.mouse.move(box["x"] + share * box["width"], box["y"] + 60)
        person.wait_for_timeout(300)
    expect(person.get_by_text("environment steps [million] · source-2")).to_be_visible()
    assert person.locator(".bk-Figure i:visible").count() > 4
    person.get_by_role("button", name=re.compile("^β")).click()
    expect(person.get_by_role("button", name=re.compile("^β"))).to_have_attribute("aria-pressed", "false")
    person.wait_for_url("**hidden=beta**")


def test_a_pause_in_one_tab_is_seen_in_the_other_and_the_run_resumed(
    person: Page, workbench: Served, store: RunStore, learning: Learning
) -> None:
    address = f"{workbench.address}/live?run={learning.run.id}"
    person.goto(address)
    other = person.context.new_page()
    other.goto(address)
    expect(other.get_by_role("button", name="Pause")).to_be_enabled()
    person.get_by_role("button", name="Pause").click()
    for page in (person, other):
        expect(page.get_by_role("button", name="Pausing …")).to_be_disabled()
    assert learning.run.pause_requested()
    learning.end("paused")
    expect(other.get_by_text("everything is saved. Resume it").first).to_be_visible()
    expect(other.get_by_text(f"workbench resume {learning.run.id} --runs")).to_be_visible()
    # As many trainings as there are cores seem to be alive: what is resumed waits.
    busy = [Learning(store, f"busy {number}") for number in range(os.cpu_count() or 1)]
    other.get_by_role("button", name="Resume").click()
    expect(person.get_by_text("queued", exact=True)).to_be_visible()
    person.get_by_role("button", name="Stop", exact=True).click()
    person.get_by_role("button", name="Stop this run").click()
    expect(other.get_by_text("stopped", exact=True)).to_be_visible()
    other.close()
    for each in busy:
        each.end("stopped")
        store.delete(each.run.id)


def test_the_end_is_a_notification_when_it_was_asked_for(person: Page, workbench: Served, learning: Learning) -> None:
    person.context.grant_permissions(["notifications"], origin=workbench.address)
    person.add_init_script(HEAR_NOTIFICATIONS)
    person.goto(f"{workbench.address}/live?run={learning.run.id}")
    bell = person.get_by_role("button", name="Notify me")
    expect(bell).to_have_attribute("aria-pressed", "false")
    bell.click()
    expect(person.get_by_role("button", name="Notifying ✓")).to_have_attribute("aria-pressed", "true")
    assert person.evaluate("window.notified") == []
    learning.end("finished")
    expect(person.get_by_role("status")).to_contain_text("Finished after")
    person.wait_for_function("window.notified.length === 1")
    assert person.evaluate("window.notified[0]")[1].startswith("finished")


def test_runs_are_walked_by_key_and_laid_over_each_other(
    person: Page, workbench: Served, store: RunStore, learning: Learning
) -> None:
    second = Learning(store, "the other one")
    person.goto(f"{workbench.address}/live?run={learning.run.id}")
    trainings = person.get_by_role("navigation", name="Trainings")
    trainings.get_by_role("checkbox", name=re.compile("^Curves of the other one")).check()
    person.wait_for_url(f"**with={second.run.id}*")
    trainings.get_by_role("button", name=re.compile("the long one")).focus()
    first = trainings.locator(".run").first.inner_text()  # both began within a second or so
    person.keyboard.press("ArrowDown" if "the long one" in first else "ArrowUp")
    person.keyboard.press("Enter")
    person.wait_for_url(f"**run={second.run.id}*")
    expect(person).to_have_title(re.compile("SubMas"))
    second.end("stopped")
    expect(person.get_by_text("Stopped by hand").first).to_be_visible()
    store.delete(second.run.id)


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (2560, 1200)])
def test_nothing_sticks_out_of_a_narrow_or_a_wide_window(
    width: int, height: int, person: Page, workbench: Served, learning: Learning
) -> None:
    person.set_viewport_size({"width": width, "height": height})
    person.goto(f"{workbench.address}/live?run={learning.run.id}&theme=default")
    expect(_chain(person)).to_have_count(4)
    expect(person.locator(".bk-Figure").last).to_be_attached()
    for part in (_chain(person).last, person.get_by_role("button", name="Notify me"), person.get_by_text("All runs")):
        box = box_of(part)
        assert box["x"] >= 0 and box["x"] + box["width"] <= width
    assert person.evaluate("document.scrollingElement.scrollWidth <= innerWidth")


def _failed(store: RunStore, name: str = "") -> Run:
    run = store.create(TrainingConfig(profile="smoke", name=name))
    run.write_state(RunState("failed", error=f"error of {name}", created="2026-01-01T00:00:00"))
    return run


def test_hostile_names_are_only_text(person: Page, workbench: Served, store: RunStore) -> None:
    runs = [_failed(store, name) for name in NAMES]
    for name in NAMES:
        append_line(runs[0].path / "events.jsonl", {"kind": name, "wall_s": 1.0, "text": f"event of {name}"})
    person.goto(f"{workbench.address}/live?run={runs[0].id}")
    expect(person.get_by_text(f"error of {NAMES[0]}").first).to_be_visible()
    for name in NAMES:
        expect(person.get_by_text(f"event of {name}")).to_be_visible()
    assert person.evaluate("window.canary") is None
    for run in runs:
        store.delete(run.id)


def test_an_unknown_run_is_a_sentence(person: Page, workbench: Served) -> None:
    for wanted, sentence in (("20200101-000000-aaaaaa", "is not in"), ("<b>x</b>", "is not a run id")):
        person.goto(f"{workbench.address}/live?run={wanted}")
        expect(person.get_by_text(sentence)).to_be_visible()
