"""S9 in a browser: names of runs, notes, tags, tasks, scenarios and policies are shown on every page, and none acts."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from agents.config import TrainingConfig
from tests.conftest import Served, start_server
from tests.security.hostile import CANARY, PRINTABLE
from tests.security.hostile_runs import fill, policy_file, said, scenario_file
from workbench.runs import Run, RunStore

MARKUP = PRINTABLE[0]
PATIENCE_MS = 60_000


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of a runs folder in which everything that has a name is named by somebody who means harm."""
    folder = tmp_path_factory.mktemp("hostile")
    store = fill(folder / "runs")
    scenario = scenario_file(folder / f"{MARKUP}.toml", MARKUP)
    for name in PRINTABLE[:3]:
        run = store.create(TrainingConfig(profile="smoke", missiles=1, name=name, scenario=str(scenario)))
        said(run, name)
        run.write_state(dataclasses.replace(run.state, state="finished"))
        policy_file(run.path / "policy.safetensors", name)
    server = start_server(folder)
    yield server
    server.process.terminate()
    server.process.wait(timeout=30)


@pytest.fixture
def visitor(page: Page, hostile: Served, complaints: list[str]) -> Page:
    """Let in to the hostile folder."""
    page.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    page.goto(f"{hostile.address}/healthz?token={hostile.token}")
    return page


def runs(hostile: Served) -> list[Run]:
    return [run for run in RunStore(hostile.runs).list() if not run.problem]


def assert_nothing_ran(page: Page) -> None:
    """No script of a name ran, in the page or a frame of it, and no element of one exists, in any shadow tree."""
    assert [frame.evaluate(f"window.{CANARY}") for frame in page.frames if "blank" not in frame.url] == [
        None for frame in page.frames if "blank" not in frame.url
    ]
    made = page.locator("img[src='x'], svg[onload], iframe[srcdoc], [onmouseover]")
    assert made.count() == 0, made.first.evaluate("(node) => node.outerHTML")


ADDRESSES = {
    "fly": "/fly?a={finished}&b=random&seed=1&scenario={scenario}",
    "fly, wrong values": "/fly?a={markup}&scenario={markup}&mask={markup}&seed={markup}&t={markup}&branch={markup}",
    "curriculum": "/curriculum?scenario={scenario}&name={markup}",
    "live": "/live?run={ended}",
    "runs": "/runs?run={ended}&show={ended},{finished}&baseline={finished}&fields=all&group=settings&smooth=50",
    "runs, wrong values": "/runs?q={markup}&run={markup}&group={markup}&sort={markup}&show=group:{markup}",
    "compare": "/compare?policies={finished},random,{markup}&tasks={markup}&episodes=10&scenario={scenario}",
    "paper": "/paper?section={markup}&result={markup}&number={markup}",
}
"""Every page, with names where it takes names and markup where it takes anything else."""
SHOWN = {"fly": ".outcome", "curriculum": ".stage", "live": "[aria-label=Trainings] button", "runs": ".head h2"}
"""What a page shows when the names have come."""


@pytest.mark.parametrize("name", ADDRESSES)
def test_no_name_acts(visitor: Page, hostile: Served, name: str) -> None:
    from urllib.parse import quote

    every = runs(hostile)
    finished = next(run for run in every if run.state.state == "finished" and run.config.name == MARKUP)
    ended = next(run for run in every if run.state.state == "failed" and run.config.name == MARKUP)
    words = {
        "finished": finished.id,
        "ended": ended.id,
        "markup": quote(MARKUP),
        "scenario": quote(finished.config.scenario),
    }
    visitor.goto(hostile.address + ADDRESSES[name].format(**words))
    expect(visitor.get_by_role("link", name="Runs", exact=True)).to_be_visible()
    visitor.wait_for_load_state("networkidle")
    if name in SHOWN:
        visitor.locator(SHOWN[name]).first.wait_for()  # a name that has not come yet cannot have acted
    expect(visitor.get_by_text("cannot be shown")).to_have_count(0)
    assert_nothing_ran(visitor)


def test_names_are_shown_as_they_are(visitor: Page, hostile: Served) -> None:
    every = {run.config.name: run for run in runs(hostile)}
    for name in (MARKUP, PRINTABLE[1], PRINTABLE[3]):
        visitor.goto(f"{hostile.address}/runs?run={every[name].id}")
        words = visitor.locator("h2", has_text=name[:20])
        expect(words).to_be_visible()
        words.hover()
        assert_nothing_ran(visitor)


def test_the_canary_is_heard_when_a_script_runs(page: Page, hostile: Served) -> None:
    # The control of this file: the same markup, let in as markup, is noticed.
    page.goto(f"{hostile.address}/healthz?token={hostile.token}")
    page.evaluate("(markup) => { document.body.innerHTML = markup }", MARKUP)
    page.wait_for_function(f"window.{CANARY} === 1")
    with pytest.raises(AssertionError):
        assert_nothing_ran(page)
