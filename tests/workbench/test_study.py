"""`workbench study envelope`: from a line to a table, one JSON object, and files."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from workbench import cli

PAGE = Path(__file__).parents[2] / "docs/envelope.md"
COLUMNS = {"nose, 0°": 0.0, "90° left": 90.0, "tail, 180°": -180.0, "90° right": -90.0}
"""Columns of the page's table, and the aspects they stand for [deg]."""

SMALL = ["study", "envelope", "expert-dragging", "--x", "launch_range_m=5e3:40e3:5", "--y", "aspect_deg=-180:120:6"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_shot_map_tells_its_boundaries(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(SMALL) == 0
    shown = capsys.readouterr().out
    assert "Where expert-dragging survives one missile" in shown
    assert "launch_range_m × aspect_deg: 5 × 6 cells, 1 flight each, seed 0" in shown
    assert "no escape from [km]" in shown and "-120" in shown


def test_json_is_one_object_and_the_files_hold_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    outs = [part for name in ("a.json", "a.csv", "a.png", "a.svg") for part in ("--out", name)]
    assert cli.main([*SMALL, "--json", *outs]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed.pop("files") == ["a.json", "a.csv", "a.png", "a.svg"]
    assert json.loads(Path("a.json").read_text()) == printed
    rows = list(csv.DictReader(Path("a.csv").read_text().splitlines()))
    assert len(rows) == 5 * 6
    flat = [share for column in printed["survived"] for share in column]
    assert [float(row["survived"]) for row in rows] == flat
    assert float(rows[-1]["launch_range_m"]) == 40e3 and float(rows[-1]["aspect_deg"]) == 120.0
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert Path("a.svg").read_text().startswith("<?xml")


def test_the_same_line_writes_the_same_bytes_on_any_number_of_threads(capsys: pytest.CaptureFixture[str]) -> None:
    for name, threads in (("one", "1"), ("two", "2")):
        line = [*SMALL, "--threads", threads, "--x", "launch_range_m=5e3:40e3:60"]
        assert cli.main([*line, "--out", f"{name}.json", "--out", f"{name}.png", "--out", f"{name}.csv"]) == 0
    for suffix in ("json", "png", "csv"):
        assert Path(f"one.{suffix}").read_bytes() == Path(f"two.{suffix}").read_bytes()


def test_two_numbers_of_the_scenario_are_whole_engagements(capsys: pytest.CaptureFixture[str]) -> None:
    line = "study envelope expert-navigation --x launch.range_m=20e3:60e3:2 --y missile.burn_s=4:12:2 --episodes 3"
    assert cli.main([*line.split(), "--mask", "2,3,4", "--out", "a.csv", "--out", "a.png", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["kind"], told["missiles"], told["episodes"]) == ("engagement", [1], 3)
    assert told["boundaries"] == []
    header = Path("a.csv").read_text().splitlines()[0]
    assert header == "launch.range_m,missile.burn_s,survived,exited,closest_m,time_s"
    assert cli.main(line.split()) == 0
    assert "whole engagements" in capsys.readouterr().out


def test_something_may_be_held_at_a_value(capsys: pytest.CaptureFixture[str]) -> None:
    line = "study envelope expert-navigation --x start.altitude_m=3e3:12e3:2 --y aspect_deg=-90:90:3 --json"
    assert cli.main([*line.split(), "--at", "launch_range_m=18e3", "--at", "missile.burn_s=9"]) == 0
    assert json.loads(capsys.readouterr().out)["held"] == {"launch_range_m": 18e3, "missile.burn_s": 9.0}


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ("--x launch_range=1:2:3", "axis 'launch_range' is unknown; use launch_range_m"),
        ("--x launch.range_m=20e3:30e3:3", "launch.range_m has no effect on a shot"),
        ("--x start.altitude_m=0:9e3:3", "start.altitude_m is 0; legal is a number from 500 to 18000"),
        ("--at missile.cd0", "'missile.cd0' is not NAME=VALUE"),
        ("--episodes 0", "--episodes is 0; legal are 1 to"),
        ("--threads 0", "--threads is 0; legal are 1 to"),
        ("--seed -1", "--seed is -1; it must not be negative"),
        ("--mask 1,2,3,4", "every missile is masked"),
        ("--mask 7", "mask names missile 7"),
        ("--out map.gif", "--out map.gif ends in '.gif'; legal are .json, .csv, .png, .svg"),
        ("--scenario nowhere", "no scenario 'nowhere'"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_code_2(
    more: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main([*SMALL, *more.split()]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("workbench: ") and sentence in err and err.count("\n") == 1


def test_a_policy_without_eyes_for_the_missile_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["study", "envelope", "submas-source-3", "--mask", "1"]) == 2
    assert "cannot see missile 2" in capsys.readouterr().err


def test_a_file_in_no_folder_is_refused_before_anything_flies(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["study", "envelope", "expert-dragging", "--out", "nowhere/a.png"]) == 1
    assert "there is no folder nowhere" in capsys.readouterr().err


def page_table() -> dict[str, dict[float, float]]:
    """Policy -> aspect [deg] -> last hit [km], as the page says."""
    lines = [line.strip("|").split("|") for line in PAGE.read_text(encoding="utf-8").splitlines() if line[:1] == "|"]
    cells = [[cell.strip() for cell in line] for line in lines]
    (header,) = (row for row in cells if row[0] == "last hit [km]")
    told = {}
    for name, *values in (row for row in cells if row[0].startswith("`")):
        told[name.strip("`")] = {COLUMNS[side]: float(km) for side, km in zip(header[1:], values, strict=True)}
    return told


@pytest.mark.parametrize("policy", ["expert-navigation", "expert-dragging", "submas-target"])
def test_the_page_tells_what_the_command_prints(policy: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["study", "envelope", policy, "--y", "aspect_deg=-180:90:4", "--json"]) == 0
    boundaries = json.loads(capsys.readouterr().out)["boundaries"]
    told = page_table()[policy]
    for row in boundaries:
        # Two cells: other rounding may move a boundary.
        assert row["last_hit_m"] / 1e3 == pytest.approx(told[row["aspect_deg"]], abs=0.6)


def test_every_picture_of_the_page_is_small_and_made_by_a_line_of_it() -> None:
    page = PAGE.read_text(encoding="utf-8")
    pictures = set(re.findall(r"\]\(([\w-]+\.png)\)", page))
    assert len(pictures) == 4
    for name in pictures:
        assert (PAGE.parent / name).stat().st_size < 200_000
        assert re.search(rf"^workbench study envelope .*--out docs/{name}$", page, re.MULTILINE)


def test_the_example_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (block,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    exec(compile(block, str(PAGE), "exec"), {})
    assert 0.0 < float(capsys.readouterr().out.split()[0]) < 1.0
