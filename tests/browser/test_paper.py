"""A reader goes through the paper: sections and their addresses, numbers and their origins, and runs an item here."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.conftest import Served
from tests.workbench.reproduce.samples import made
from workbench.reproduce.job import read_job
from workbench.reproduce.result_file import save

PATIENCE_S = 240.0


@pytest.fixture
def results(workbench: Served) -> Path:
    """Results of this runs folder: two seeds of Table 4 and Fig. 8."""
    folder = workbench.runs / "results" / "fast"
    for item in ("table4", "fig8"):
        save(made(item, seeds=2, success=lambda v, t, s, p: 0.9 + 0.02 * s), folder / f"{item}.json")
    return folder


def test_a_reader_goes_back_and_forth(person: Page, workbench: Served, results: Path) -> None:
    person.goto(f"{workbench.address}/paper?results=fast-here")
    contents = person.get_by_role("navigation", name="Tables and figures")
    expect(person.get_by_role("heading", name="Scorecard")).to_be_visible()
    contents.get_by_role("button", name="Table 2").click()
    expect(person.get_by_text("why fast differs")).to_be_visible()
    assert "section=table2" in person.url
    contents.get_by_role("button", name="Fig. 8").click()
    chip = person.get_by_role("button", name="DecPd")
    chip.click()
    expect(chip).to_have_attribute("aria-pressed", "false")
    person.wait_for_url("**hide=dec-pd*")
    contents.get_by_role("button", name="Table 3").click()
    expect(person.get_by_role("heading", name="Table 3")).to_be_visible()
    person.go_back()
    expect(person.get_by_role("heading", name="Fig. 8")).to_be_visible()
    assert "section=fig8" in person.url
    person.go_forward()
    expect(person.get_by_role("heading", name="Table 3")).to_be_visible()
    person.goto(f"{workbench.address}/paper#table1")
    expect(person.get_by_role("heading", name="Table 1")).to_be_visible()
    person.wait_for_url("**/paper?section=table1")


def test_a_number_tells_where_it_comes_from(person: Page, workbench: Served, results: Path) -> None:
    person.goto(f"{workbench.address}/paper?section=table4&results=fast-here")
    person.get_by_role("row", name="SubMas-RL").get_by_role("button", name="(seed 1)").first.click()
    origin = person.get_by_role("region", name="Where this number comes from")
    expect(origin).to_contain_text("SubMas-RL, target task, seed 1")
    expect(origin.get_by_role("button", name="Copy: workbench evaluate runs/")).to_be_visible()
    person.wait_for_url("**number=submas.target.1.report*")
    person.reload()
    expect(person.get_by_role("region", name="Where this number comes from")).to_contain_text("seed 1")
    with person.expect_download() as download:
        person.get_by_role("button", name="Result set, JSON").click()
    assert json.loads(Path(download.value.path()).read_text())["item"] == "table4"


def test_an_item_is_run_here_and_stopped(person: Page, workbench: Served) -> None:
    person.goto(f"{workbench.address}/paper?section=fig9&results=smoke-here")
    expect(person.get_by_text("Nothing to draw yet")).to_be_visible()
    for label in ("Seeds of SubMas-RL", "of each baseline"):
        person.get_by_label(label, exact=True).fill("1")
        person.get_by_label(label, exact=True).press("Enter")
    expect(person.get_by_text("4 trainings; 4 evaluations")).to_be_visible()
    person.get_by_role("button", name="Run this").click()
    expect(person.get_by_text("Running: fig9")).to_be_visible()
    expect(person.get_by_role("button", name="Run this")).to_be_disabled()
    person.get_by_role("button", name="Stop", exact=True).click()
    person.get_by_role("button", name="Stop them as well").click()
    deadline = time.monotonic() + PATIENCE_S
    while (job := read_job(workbench.runs, "trainings")) is None or job.alive:
        assert time.monotonic() < deadline
        time.sleep(0.5)
    assert job.state == "interrupted"
    expect(person.get_by_text("Stopped: fig9")).to_be_visible()
    expect(person.get_by_role("button", name="Run this")).to_be_enabled()
