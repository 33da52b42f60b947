"""The export menu hands the browser what `fly --out` would have written, and an order it does not know nothing."""

from __future__ import annotations

import asyncio
import io
from dataclasses import asdict
from pathlib import Path

import numpy as np
import param
import pytest
from PIL import Image

from agents.policy import bind
from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Outcome
from tests.workbench.flights import branched, ending, shorten_films
from workbench import export_job
from workbench.branch import Branch, fly_branch
from workbench.export_menu import CHOICES, ExportMenu
from workbench.exports import FORMATS, TOGETHER, encode
from workbench.pages.fly_flights import fly_both
from workbench.pages.fly_settings import default_settings, read_settings
from workbench.pages.fly_start import start_of
from workbench.policies import resolve_policy
from workbench.runs import RunStore

QUERY = {"a": "expert-dragging", "b": "expert-navigation", "mask": "1,2,3,4", "seed": "3"}


def menu(tmp_path: Path, **query: str) -> ExportMenu:
    made = ExportMenu()
    made.offer(ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN), {**QUERY, **query}, tmp_path)
    return made


def ask(made: ExportMenu, suffix: str, who: str) -> None:
    with param.parameterized.discard_events(made):
        made.asked = [suffix, who, 1]
    asyncio.run(made._make())


def test_every_entry_is_a_format_and_every_format_has_one() -> None:
    assert {suffix for suffix, *_ in CHOICES} | {".acmi"} == set(FORMATS)
    assert all(choice["all"] == (choice["suffix"] in TOGETHER) for choice in ExportMenu().choices)


@pytest.mark.parametrize(("who", "outcome"), [("A", Outcome.EXIT), ("B", Outcome.SHOT_DOWN)])
def test_a_table_of_either_flight_is_the_one_the_command_writes(who: str, outcome: Outcome, tmp_path: Path) -> None:
    made = menu(tmp_path)
    ask(made, ".csv", who)
    assert made.file["data"] == encode(ending(outcome), ".csv")
    assert made.file["name"] == f"flight-{ending(outcome).seed}-{who}.csv"
    assert (made.busy, made.share) == ("", -1.0)


def test_a_branch_is_offered_as_long_as_there_is_one(tmp_path: Path) -> None:
    made, branch = menu(tmp_path), branched()
    made.offer_branch(branch)
    assert made.who == ["A", "B", "B′"]
    ask(made, ".csv", "B′")
    assert made.file["data"] == encode(branch, ".csv")
    assert made.file["name"] == f"flight-{branch.seed}-B-from-30s-by-hand-then-circle.csv"
    made.offer_branch(None)
    assert made.who == ["A", "B"]
    made.file = {}
    ask(made, ".csv", "B′")
    assert made.file == {}


@pytest.mark.parametrize("order", [(".exe", "A"), (".csv", "all"), (".html", "A"), (".csv", "<b>")])
def test_an_entry_that_is_not_there_makes_nothing(order: tuple[str, str], tmp_path: Path) -> None:
    made = menu(tmp_path)
    ask(made, *order)
    assert made.file == {}


def test_what_goes_wrong_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> bytes:
        raise SubMasError("the disk is full")

    made = menu(tmp_path)
    monkeypatch.setattr("workbench.export_menu.encode", fail)
    ask(made, ".csv", "A")
    assert (made.busy, made.share, made.file) == ("the disk is full.", -1.0, {})


def test_a_process_of_its_own_complains_in_one_sentence(tmp_path: Path) -> None:
    made = menu(tmp_path, a="nobody")
    ask(made, ".gif", "all")
    assert "nobody" in made.busy
    assert "Traceback" not in made.busy
    assert made.file == {}


def test_the_job_says_how_far_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shorten_films(monkeypatch)
    branch = {"of": "A", "step": 3, "headings_deg": [90, 45], "policy": "random"}
    export_job.make(export_job.Order(QUERY, branch, str(tmp_path), str(tmp_path / "x.gif")))
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [int(done) for done, _total in lines] == list(range(1, len(lines) + 1))
    with Image.open(io.BytesIO((tmp_path / "x.gif").read_bytes())) as animation:
        assert animation.n_frames > 1
        assert b"expert-dragging, from 3 s by hand, then random" in animation.info["comment"]


def test_the_job_flies_what_the_page_shows(tmp_path: Path) -> None:
    """The initial state of an address is more than its seed: an episode of it, or one missile fired at once."""
    query = {**QUERY, "mask": "", "episode": "4", "shot": "22000,-40"}
    settings, _ = read_settings(query, [QUERY["a"], QUERY["b"]], ["default"], default_settings([]))
    shown = fly_both(settings, RunStore(tmp_path))
    original = {"A": shown.a, "B": shown.b}["B"]
    branch = Branch("B", 2, (10, 20), "random")
    task = original.task
    state = start_of(Task(load_scenario("default")), settings)[1]
    left = fly_branch(original, branch, bind(resolve_policy("random"), task), 2, state)
    order = export_job.Order(query, asdict(branch), str(tmp_path), "")
    for one, again in zip((shown.a, shown.b, left), export_job.flown(order), strict=True):
        np.testing.assert_array_equal(one.action_rad, again.action_rad)
        assert (one.episode, one.outcome, one.departure) == (again.episode, again.outcome, again.departure)
