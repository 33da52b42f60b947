"""The study of stability: what is still to do, its file, its table, its picture, its command and its page."""

from __future__ import annotations

import dataclasses
import io
import json
from pathlib import Path

import pytest
from PIL import Image

import workbench.stability
from agents.remedies import REMEDIES
from agents.trial import Trial
from layouts.stability import Panel, picture
from tests.agents.test_trial import trial
from workbench.cli import main
from workbench.reproduce.places import ROOT
from workbench.stability import COLUMNS, StabilityFileError, Wish, load, markdown, panels, rows, save, wishes


def of(remedy: str, seed: int, *success: float) -> Trial:
    return dataclasses.replace(trial(*success), remedy=remedy, seed=seed, final_success_rate=success[-1])


FOUND = [of("haste", 1, 0.5, 0.4), of("none", 0, 0.0, 0.95, 1.0), of("haste", 0, 1.0, 0.9), of("haste", 2, 0.96, 0.2)]


def test_what_is_known_is_not_wanted_again_and_seeds_come_before_remedies() -> None:
    assert wishes(["none", "haste"], range(2), FOUND) == [Wish("none", 1)]
    assert wishes(["none", "haste"], range(3), []) == [Wish(r, s) for s in range(3) for r in ("none", "haste")]


def test_a_file_gives_back_the_trials_in_order(tmp_path: Path) -> None:
    path = tmp_path / "new" / "trials.jsonl"
    save(path, FOUND)
    assert [(one.remedy, one.seed) for one in load(path)] == [("none", 0), ("haste", 0), ("haste", 1), ("haste", 2)]
    assert set(load(path)) == set(FOUND)
    assert load(tmp_path / "none.jsonl") == []


@pytest.mark.parametrize("line", ["{", "[]", '{"remedy": "none"}', json.dumps(FOUND[0].to_json() | {"epochs": []})])
def test_a_damaged_file_is_named_with_its_line(tmp_path: Path, line: str) -> None:
    path = tmp_path / "trials.jsonl"
    path.write_text(json.dumps(FOUND[0].to_json()) + "\n" + line + "\n")
    with pytest.raises(StabilityFileError, match=r"trials\.jsonl, line 2, is no trial"):
        load(path)


def test_the_table_has_medians_and_extremes_in_percent() -> None:
    assert rows(FOUND) == [
        (REMEDIES["none"].says, "1 of 1", "4 [4, 4]", "0.0 [0.0, 0.0]", "65.0 [65.0, 65.0]", "100.0 [100.0, 100.0]"),
        (REMEDIES["haste"].says, "2 of 3", "2 [2, 2]", "10.0 [10.0, 76.0]", "58.0 [45.0, 95.0]", "40.0 [20.0, 90.0]"),
    ]


def test_the_picture_has_a_panel_for_each_and_is_the_same_again() -> None:
    shown = [Panel(*one) for one in panels(FOUND)]
    assert [len(panel.seeds) for panel in shown] == [1, 3]
    drawn = picture(shown)
    assert drawn == picture(shown) and Image.open(io.BytesIO(drawn)).format == "PNG"
    assert drawn != picture(shown[:1])


def test_the_command_trains_what_is_missing_and_keeps_what_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "trials.jsonl"
    save(path, FOUND)
    asked: list[Wish] = []

    def trained(wanted: list[Wish], workers: int) -> object:
        asked.extend(wanted)
        yield of("none", 1, 1.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(workbench.stability, "trials", trained)
    assert main(["stability", "--remedies", "haste", "--seeds", "3", "--out", str(path), "--json"]) == 130
    assert asked == [Wish("none", 1), Wish("none", 2)]
    told = json.loads(capsys.readouterr().out)
    assert told["interrupted"] and len(told["trials"]) == 5 and len(load(path)) == 5
    assert path.with_suffix(".png").is_file()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (["--remedies", "prayer"], "--remedies 'prayer' is unknown; known are none, one-step"),
        (["--seeds", "0"], "--seeds is 0; legal are 1 to 100"),
        (["--at-once", "0"], "--at-once is 0; legal are 1 to 256"),
    ],
)
def test_a_mistake_is_a_sentence(given: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stability", *given]) == 2
    assert sentence in capsys.readouterr().err


def test_the_page_shows_the_committed_trials() -> None:
    found = load(ROOT / "assets/results/stability.jsonl")
    text = (ROOT / "docs/stability.md").read_text(encoding="utf-8")
    written = text.split("<!-- stability -->\n")[1].split("\n<!-- end -->")[0]
    assert written == markdown(found)
    assert all(column in markdown(FOUND) for column in COLUMNS)
