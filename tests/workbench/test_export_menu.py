"""The export menu hands the browser what `fly --out` would have written, and an order it does not know nothing."""

from __future__ import annotations

import asyncio
import io
from pathlib import Path

import param
import pytest
from PIL import Image

from sim.errors import SubMasError
from sim.world import Outcome
from tests.workbench.flights import ending, shorten_films
from workbench import export_job
from workbench.export_menu import CHOICES, ExportMenu
from workbench.exports import FORMATS, TOGETHER, encode


def menu(tmp_path: Path, specs: tuple[str, str] = ("expert-dragging", "expert-navigation")) -> ExportMenu:
    made = ExportMenu()
    made.offer(ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN), specs, tmp_path, "default")
    return made


def ask(made: ExportMenu, suffix: str, who: str) -> None:
    with param.parameterized.discard_events(made):
        made.asked = [suffix, who, 1]
    asyncio.run(made._make())


def test_every_entry_is_a_format_and_every_format_has_one() -> None:
    assert {suffix for suffix, *_ in CHOICES} | {".acmi"} == set(FORMATS)
    assert all((who == "AB") == (suffix in TOGETHER) for suffix, who, *_ in CHOICES)


@pytest.mark.parametrize(("who", "outcome"), [("A", Outcome.EXIT), ("B", Outcome.SHOT_DOWN)])
def test_a_table_of_either_flight_is_the_one_the_command_writes(who: str, outcome: Outcome, tmp_path: Path) -> None:
    made = menu(tmp_path)
    ask(made, ".csv", who)
    assert made.file["data"] == encode(ending(outcome), ".csv")
    assert made.file["name"] == f"flight-{ending(Outcome.EXIT).seed}.csv"
    assert (made.busy, made.share) == ("", -1.0)


@pytest.mark.parametrize("order", [(".exe", "A"), (".csv", "AB"), (".csv", "<b>")])
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
    made = menu(tmp_path, ("nobody", "expert-dragging"))
    ask(made, ".gif", "AB")
    assert "nobody" in made.busy
    assert "Traceback" not in made.busy
    assert made.file == {}


def test_the_job_says_how_far_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shorten_films(monkeypatch)
    order = {"a": "expert-dragging", "b": "random", "masked": [1, 2, 3, 4], "seed": 3, "scenario": "default"}
    export_job.make({**order, "runs": str(tmp_path), "out": str(tmp_path / "x.gif")})
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [int(done) for done, _total in lines] == list(range(1, len(lines) + 1))
    with Image.open(io.BytesIO((tmp_path / "x.gif").read_bytes())) as animation:
        assert animation.n_frames > 1
