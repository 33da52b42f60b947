"""A person searches, compares, groups, tags, deletes and brings back runs; hostile names stay text."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from agents.config import TrainingConfig
from tests.conftest import Served
from workbench.bench.runs import make_runs
from workbench.run_files import append_line
from workbench.run_notes import RunNotes, read_notes, write_notes
from workbench.run_state import RunState
from workbench.runs import Run, RunStore

NAMES = [
    "<img src=x onerror=window.canary=1>", "<script>window.canary=1</script>", "{{7*7}}", "${7*7}", "=HYPERLINK(1)",
    "'; DROP TABLE runs; --", "%s{0}", "../../x", "**bold**", "a" * 200,
]  # fmt: skip
"""Names people and programs could give to runs; none may do anything (S9)."""
MADE = 300


@pytest.fixture
def store(workbench: Served) -> RunStore:
    """The runs of the server of this module: three hundred that were never trained, to begin with."""
    found = RunStore(workbench.runs)
    if not any(path.name.startswith("2026") for path in workbench.runs.iterdir()):
        make_runs(workbench.runs, MADE, epochs=8)
    return found


def _failed(store: RunStore, name: str) -> Run:
    run = store.create(TrainingConfig(profile="smoke", name=name))
    run.write_state(RunState("failed", error=f"error of {name}", created="2026-12-31T00:00:00"))
    return run


def _row(page: Page, name: str) -> Locator:
    return page.get_by_role("row").filter(has=page.get_by_text(name, exact=True))


def test_runs_are_found_and_their_curves_compared(person: Page, workbench: Served, store: RunStore) -> None:
    person.goto(f"{workbench.address}/runs")
    expect(person.get_by_role("status")).to_have_text(f"{MADE} runs")
    expect(_row(person, "Defensive-dragging expert")).to_contain_text("61.7 %")
    person.get_by_role("searchbox", name="Search runs").fill("bench-000")
    expect(person.get_by_role("status")).to_have_text(f"10 of {MADE} runs")
    for name in ("bench-0003", "bench-0004"):
        person.get_by_role("checkbox", name=f"Curve of {name}").click()
        expect(person.get_by_role("checkbox", name=f"Curve of {name}")).to_be_checked()
    expect(person.get_by_text("bench-0003 · submas · seed 3", exact=True).first).to_be_visible()
    expect(person.get_by_role("rowheader", name="seed", exact=True)).to_be_visible()
    person.wait_for_function(
        "Bokeh.documents.flatMap(d => [...d._all_models.values()]).filter(m => m.data?.dash?.length === 2).length === 2"
    )
    person.wait_for_url(re.compile(r"show=\S+%2C"))
    person.reload()
    expect(person.get_by_role("checkbox", name="Curve of bench-0004")).to_be_checked()
    expect(person.get_by_role("searchbox", name="Search runs")).to_have_value("bench-000")


def test_a_run_is_pinned_smoothed_over_time_and_traced_back_to_its_guide(
    person: Page, workbench: Served, store: RunStore
) -> None:
    first, second = (store.list()[-1 - place] for place in (3, 4))
    guided = store.create(TrainingConfig(profile="smoke", name="guided one", guide=first.id))
    person.goto(f"{workbench.address}/runs?q=bench-000&run={first.id}&show={second.id}")
    lineage = person.get_by_role("listitem").filter(has_text=re.compile("Navigation|source-3|target"))
    expect(lineage.first).to_contain_text("guides the first stage")
    expect(person.get_by_role("link", name="guided one")).to_have_attribute("href", f"/runs?run={guided.id}")
    person.get_by_role("button", name="Pin as baseline").click()
    expect(person.locator(".row.pinned")).to_contain_text("bench-0003")
    axis = person.get_by_role("combobox", name="Horizontal axis")
    axis.press("Enter")
    expect(person.get_by_role("listbox")).to_contain_text("epochs")
    for key in ("ArrowDown", "Enter"):  # by key: a menu that unfolds moves away under the pointer
        person.keyboard.press(key)
    expect(axis).to_have_text("time")
    person.get_by_role("slider").first.press("End")
    person.wait_for_url(re.compile(rf"baseline={first.id}.*x=time.*smooth=\d\d"))
    person.reload()
    expect(person.locator(".row.pinned")).to_contain_text("bench-0003")
    expect(person.get_by_role("button", name="Unpin")).to_be_visible()
    expect(axis).to_have_text("time")
    store.delete(guided.id)


def test_groups_facets_and_the_way_back(person: Page, workbench: Served, store: RunStore) -> None:
    person.goto(f"{workbench.address}/runs")
    person.get_by_role("combobox", name="Group runs by").select_option("variant")
    group = person.locator(".row.group").filter(has_text="wo-pd")
    expect(group).to_contain_text(re.compile(r"\d+\.\d %\s+\d+\.\d–\d+\.\d"))
    person.wait_for_url("**group=variant**")
    person.get_by_role("button", name="State ▾").click()
    person.get_by_role("checkbox", name=re.compile("^failed")).check()
    person.keyboard.press("Escape")
    expect(person.get_by_role("status")).to_have_text(re.compile(rf"^\d+ of {MADE} runs"))
    person.wait_for_url("**state=failed**")
    person.go_back()
    expect(person.get_by_role("status")).to_have_text(f"{MADE} runs")
    expect(person.get_by_role("combobox", name="Group runs by")).to_have_value("variant")
    person.go_forward()
    expect(person.get_by_role("status")).to_have_text(re.compile(rf"of {MADE} runs"))


def test_thousands_are_scrolled_and_walked_by_key(person: Page, workbench: Served, store: RunStore) -> None:
    person.goto(f"{workbench.address}/runs?sort=name")
    expect(_row(person, "bench-0000")).to_be_visible()
    person.locator(".view").evaluate("view => { view.scrollTop = view.scrollHeight }")
    expect(_row(person, f"bench-{MADE - 1:04}")).to_be_visible()
    person.locator(".view").evaluate("view => { view.scrollTop = 0 }")
    expect(_row(person, "bench-0000")).to_be_visible()
    person.get_by_role("grid", name="Runs").focus()
    person.keyboard.press("ArrowDown")
    expect(person.get_by_role("heading", name="bench-0000")).to_be_visible()
    person.keyboard.press("ArrowDown")
    expect(person.get_by_role("heading", name="bench-0001")).to_be_visible()


def test_notes_and_tags_are_written_and_found(person: Page, workbench: Served, store: RunStore) -> None:
    run = _failed(store, "to be remembered")
    person.goto(f"{workbench.address}/runs?q=remembered&run={run.id}")
    person.get_by_label("Note", exact=True).fill("<b>milk</b>")
    person.get_by_label("Tags, separated by commas").first.fill("shopping")
    person.get_by_label("Tags, separated by commas").first.blur()
    expect(_row(person, "to be remembered")).to_contain_text("shopping")
    assert read_notes(run.path) == RunNotes("<b>milk</b>", ("shopping",))
    person.goto(f"{workbench.address}/runs?tag=shopping")
    expect(person.get_by_role("status")).to_have_text(re.compile("^1 of "))
    store.delete(run.id)


def test_a_run_is_deleted_and_brought_back(person: Page, workbench: Served, store: RunStore) -> None:
    run = _failed(store, "needle")
    person.goto(f"{workbench.address}/runs?q=needle")
    person.get_by_text("needle", exact=True).click()
    expect(person.get_by_role("link", name="Open in Live")).to_have_attribute("href", f"/live?run={run.id}")
    person.get_by_role("button", name="Delete").click()
    person.get_by_role("button", name="Move to the trash").click()
    expect(person.get_by_text("1 run moved to the trash.")).to_be_visible()
    assert run.id not in {each.id for each in store.list()}
    person.get_by_role("button", name="Undo").click()
    expect(person.get_by_text("1 run brought back from the trash.")).to_be_visible()
    assert run.id in {each.id for each in store.list()}
    store.delete(run.id)
    person.goto(f"{workbench.address}/runs?view=trash&q=needle&run={run.id}")
    person.get_by_role("button", name="Restore").click()
    expect(person.get_by_text(re.compile("^No run fits|^The trash is empty"))).to_be_visible()
    assert run.id in {each.id for each in store.list()}
    store.delete(run.id)


def test_a_damaged_run_stands_among_the_others(person: Page, workbench: Served, store: RunStore) -> None:
    bad = store.create(TrainingConfig())
    (bad.path / "config.json").write_text("{")
    person.goto(f"{workbench.address}/runs?run={bad.id}")
    expect(_row(person, bad.id)).to_contain_text("config.json is not JSON")
    expect(_row(person, f"bench-{MADE - 1:04}")).to_be_visible()
    store.delete(bad.id)


def test_hostile_names_are_only_text(person: Page, workbench: Served, store: RunStore) -> None:
    runs = [_failed(store, name) for name in NAMES]
    for run, name in zip(runs, NAMES, strict=True):
        write_notes(run.path, RunNotes(name, (name[:40].replace(",", ""),)))
        append_line(run.path / "metrics.jsonl", {"stage": 0, "task": name, "epoch": 1, "success_rate": 0.5})
    shown = ",".join(run.id for run in runs[:4])
    person.goto(f"{workbench.address}/runs?q=error&run={runs[0].id}&show={shown}")
    for name in NAMES:
        expect(person.get_by_role("row").filter(has_text=name).first).to_be_visible()
    expect(person.get_by_text(f"error of {NAMES[0]}")).to_be_visible()
    expect(person.get_by_role("columnheader", name=NAMES[1])).to_be_visible()
    person.get_by_role("button", name="Tags ▾").click()
    expect(person.get_by_role("checkbox", name=f"{NAMES[0]} 1")).to_be_visible()
    person.keyboard.press("Escape")
    person.get_by_role("button", name="Delete", exact=True).click()
    expect(person.get_by_text(f"{NAMES[0]} is moved")).to_be_visible()
    assert person.evaluate("window.canary") is None
    for run in runs:
        store.delete(run.id)


def test_an_empty_folder_says_what_to_do(visitor: Page, served: Served) -> None:
    visitor.goto(f"{served.address}/runs")
    expect(visitor.get_by_text("No run yet. Launch one on the Curriculum page")).to_be_visible()
    assert not list(Path(served.runs).glob("2*"))
