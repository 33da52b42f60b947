"""A person finds runs, opens and deletes them; hostile names stay text."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from agents.config import TrainingConfig
from tests.conftest import Served
from workbench.run_files import append_line
from workbench.run_state import RunState
from workbench.runs import Run, RunStore

NAMES = [
    "<img src=x onerror=window.canary=1>", "<script>window.canary=1</script>", "{{7*7}}", "${7*7}", "=HYPERLINK(1)",
    "'; DROP TABLE runs; --", "%s{0}", "../../x", "**bold**", "a" * 200,
]  # fmt: skip
"""Names people and programs could give to runs; none may do anything (S9)."""


@pytest.fixture
def store(workbench: Served) -> RunStore:
    return RunStore(workbench.runs)


def _failed(store: RunStore, name: str = "") -> Run:
    run = store.create(TrainingConfig(profile="smoke", name=name))
    run.write_state(RunState("failed", error=f"error of {name}", created="2026-01-01T00:00:00"))
    return run


def test_hostile_names_are_only_text(person: Page, workbench: Served, store: RunStore) -> None:
    runs = [_failed(store, name) for name in NAMES]
    for name in NAMES:
        append_line(runs[0].path / "events.jsonl", {"kind": name, "wall_s": 1.0, "text": f"event of {name}"})
    person.goto(f"{workbench.address}/live?run={runs[0].id}")
    expect(person.get_by_text(f"error of {NAMES[0]}")).to_be_visible()
    for name in NAMES:
        expect(person.get_by_text(f"event of {name}")).to_be_visible()
    assert person.evaluate("window.canary") is None
    for run in runs:
        store.delete(run.id)


def test_an_unknown_run_is_a_sentence(person: Page, workbench: Served) -> None:
    for wanted, sentence in (("20200101-000000-aaaaaa", "is not in"), ("<b>x</b>", "is not a run id")):
        person.goto(f"{workbench.address}/live?run={wanted}")
        expect(person.get_by_text(sentence)).to_be_visible()
