"""`workbench calibrate`: the table, its JSON, the search, and what each refuses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import agents.calibration
import agents.scenario_search
from agents.calibration import Progress
from agents.calibration_table import Calibration, LeftOut, Target
from agents.scenario_dials import drawn, with_settings
from agents.scenario_search import Candidate
from sim.scenario import Scenario
from sim.scenario_file import load_scenario, scenario_text
from tests.engagements import changed
from workbench import cli, scenario_search
from workbench.launcher import environment

LINES = (
    Target("sure", 0.62, 0.59, 0.65, (0.6, 0.64)),
    Target("inside", 0.62, 0.59, 0.65, (0.58, 0.66)),
    Target("outside", 0.66, 0.59, 0.65, (0.64, 0.68)),
    Target("far", 0.7, 0.59, 0.65, (0.66, 0.74)),
    Target("never", float("nan"), 850.0, 1000.0),
    Target("exact", 80.0, 80.0, 80.0, (80.0, 80.0)),
)


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def measured(lines: tuple[Target, ...], left_out: tuple[LeftOut, ...] = ()) -> Calibration:
    """A table as if it had been flown."""
    return Calibration("drill", 48, 7, lines, left_out)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, str]]:
    """Episodes and scenario of every calibration, which is not flown."""
    calls: list[tuple[int, str]] = []

    def calibrate(episodes: int, progress: Progress | None, scenario: Scenario) -> Calibration:
        calls.append((episodes, scenario.name))
        return measured(LINES, (LeftOut("step", "of no use"),))

    monkeypatch.setattr(agents.calibration, "calibrate", calibrate)
    return calls


@pytest.fixture
def no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever begins to fly candidates fails."""

    def measure(*_: object, **__: object) -> Calibration:
        raise AssertionError("a candidate was flown")

    monkeypatch.setattr(agents.scenario_search, "measure", measure)


@pytest.fixture
def short() -> str:
    """A scenario file in which every flight is over after a minute."""
    Path("short.toml").write_text(scenario_text(changed(load_scenario(), rules={"max_steps": 60, "substeps": 4})))
    return "short.toml"


def candidate(number: int, value: float, rung: int = 0) -> Candidate:
    """A candidate with one measured line."""
    settings = drawn(np.random.default_rng(number))
    scenario = with_settings(load_scenario(), settings, f"candidate-{number}", "")
    line = Target("x", value, 0.0, 0.3, (value - 0.1, value + 0.1))
    return Candidate(number, settings, scenario, rung, measured((line,)), rung == 2 and line.ok)


def search_that_yields(*steps: Candidate | BaseException) -> Callable[..., Iterator[Candidate]]:
    """A search that gives these candidates, or raises."""

    def search(*_: Any) -> Iterator[Candidate]:
        for step in steps:
            if isinstance(step, BaseException):
                raise step
            yield step

    return search


def test_the_table_shows_values_intervals_and_verdicts(
    asked: list[tuple[int, str]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["calibrate"]) == 1
    assert asked == [(1000, "default")]
    shown = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert "sure 0.62 0.6 to 0.64 0.59 to 0.65 ok" in shown
    assert "inside 0.62 0.58 to 0.66 0.59 to 0.65 undecided, value ok" in shown
    assert "outside 0.66 0.64 to 0.68 0.59 to 0.65 undecided, value missed" in shown
    assert "far 0.7 0.66 to 0.74 0.59 to 0.65 MISSED" in shown
    assert "never – – 850 to 1000 MISSED" in shown
    assert "exact 80 80 to 80 80 ok" in shown
    assert "left out: step (of no use)" in shown
    assert "3 of 6 targets met, shortfall 1.06" in shown


def test_the_json_keeps_its_promise(
    asked: list[tuple[int, str]], capsys: pytest.CaptureFixture[str], short: str
) -> None:
    assert cli.main(["calibrate", "--episodes", "12", "--scenario", short, "--json"]) == 1
    assert asked == [(12, "default")]
    figures = json.loads(capsys.readouterr().out)
    assert [set(target) for target in figures["targets"]] == [
        {"name", "value", "low", "high", "ok", "ci95", "verdict"}
    ] * len(LINES)
    assert figures["targets"][4]["value"] is None
    assert figures["left_out"] == [{"name": "step", "reason": "of no use"}]


def test_all_targets_met_is_exit_code_0(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agents.calibration, "calibrate", lambda *_: measured(LINES[:2]))
    assert cli.main(["calibrate"]) == 0


MISTAKES = [
    ("--episodes 0", "--episodes is 0; legal are 1 to 1000000"),
    ("--scenario nowhere", "no scenario 'nowhere'; there are default"),
    ("--seed 3", "--seed belongs to a search; add --search"),
    ("--seed 0", "--seed belongs to a search; add --search"),
    ("--out mine.toml", "--out belongs to a search; add --search"),
    ("--force", "--force belongs to a search; add --search"),
    ("--search", "--search needs a file to write; add --out and a name such as mine.toml"),
    ("--search --out mine.toml --episodes 5", "--episodes does not go with --search"),
    ("--search --out mine.toml --seed -1", "--seed is -1; it must not be negative"),
    ("--search --out mine.toml --candidates 0", "--candidates is 0; legal are 1 to 100000"),
    ("--search --out mine.toml --minutes 0", "--minutes is 0; legal is more than 0 and at most 10080 (a week)"),
    ("--search --out mine.toml --minutes nan", "--minutes is nan; legal is more than 0"),
    ("--search --out mine.json", "--out mine.json is not a .toml file; a scenario file is"),
    ("--search --out nowhere/mine.toml", "--out nowhere/mine.toml: there is no folder nowhere"),
    ("--search --out old.toml", "--out old.toml exists already; name another file, or add --force to replace it"),
    ("--search --out folder.toml --force", "--out folder.toml is a folder"),
    ("--search --out mine.toml --scenario nowhere", "no scenario 'nowhere'"),
    ("--search --out mine.toml --scenario wide.toml", "proposal from 'default': the exit gate reaches beyond"),
]


@pytest.mark.usefixtures("asked", "no_search")
@pytest.mark.parametrize(("line", "sentence"), MISTAKES, ids=[line for line, _ in MISTAKES])
def test_a_mistake_is_one_sentence_and_exit_code_2(
    line: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("old.toml").write_text("precious")
    Path("folder.toml").mkdir()
    wide = changed(load_scenario(), battlefield={"exit_half_width_m": 37.6e3})
    Path("wide.toml").write_text(scenario_text(wide))
    assert cli.main(["calibrate", *line.split()]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("workbench: ")
    assert sentence in err
    assert err.count("\n") == 1
    assert Path("old.toml").read_text() == "precious"
    assert not Path("mine.toml").exists()


def test_a_search_writes_a_scenario_that_says_how_it_was_found(capsys: pytest.CaptureFixture[str], short: str) -> None:
    line = f"calibrate --search --scenario {short} --seed 4 --candidates 3 --out mine.toml"
    assert cli.main([*line.split(), "--json"]) == 1  # nobody arrives within a minute
    out, err = capsys.readouterr()
    found = json.loads(out)
    assert found["search"]["tried"] == 3
    assert (found["search"]["seed"], found["search"]["file"]) == (4, "mine.toml")
    assert "best so far: candidate 1, shortfall" in err
    mine = load_scenario("mine.toml")
    assert mine.name == found["scenario"] == "mine"
    assert mine.description.startswith(
        f"Found by workbench {line}: candidate {found['search']['candidate']}, shortfall"
    )
    assert mine.rules.max_steps == 60
    before = Path("mine.toml").read_bytes()
    assert cli.main([*line.split(), "--force"]) == 1
    assert Path("mine.toml").read_bytes() == before


def test_a_search_that_meets_every_target_is_exit_code_0(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    steps = (candidate(1, 0.9), candidate(2, 0.2), candidate(2, 0.2, rung=1), candidate(2, 0.1, rung=2))
    monkeypatch.setattr(scenario_search, "search", search_that_yields(*steps))
    assert cli.main(["calibrate", "--search", "--out", "mine.toml"]) == 0
    assert "--seed 0 --candidates 200 --out mine.toml: candidate 2" in load_scenario("mine.toml").description
    assert "workbench calibrate --scenario mine.toml" in capsys.readouterr().out


def test_ctrl_c_keeps_the_best_so_far(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    steps = (candidate(1, 0.9), candidate(2, 0.35), candidate(3, 0.6), KeyboardInterrupt())
    monkeypatch.setattr(scenario_search, "search", search_that_yields(*steps))
    assert cli.main(["calibrate", "--search", "--minutes", "5", "--out", "mine.toml", "--json"]) == 130
    found = json.loads(capsys.readouterr().out)["search"]
    assert (found["interrupted"], found["candidate"], found["tried"]) == (True, 2, 3)
    assert load_scenario("mine.toml").launch == steps[1].scenario.launch


def test_a_candidate_that_was_only_lucky_at_first_is_not_the_best(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = (candidate(1, 0.35), candidate(2, 0.2), candidate(2, 0.9, rung=1), candidate(3, 0.6))
    monkeypatch.setattr(scenario_search, "search", search_that_yields(*steps))
    assert cli.main(["calibrate", "--search", "--out", "mine.toml"]) == 1
    assert ": candidate 1, shortfall 0.050" in load_scenario("mine.toml").description


def test_ctrl_c_before_anything_is_measured_writes_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(scenario_search, "search", search_that_yields(KeyboardInterrupt()))
    assert cli.main(["calibrate", "--search", "--out", "mine.toml"]) == 130
    assert capsys.readouterr().err == "workbench: interrupted\n"
    assert not Path("mine.toml").exists()


def test_a_minute_budget_cuts_the_search(capsys: pytest.CaptureFixture[str], short: str) -> None:
    line = f"calibrate --search --scenario {short} --minutes 1e-9 --out mine.toml"
    assert cli.main(line.split()) == 1
    assert capsys.readouterr().err == (
        "workbench: no candidate was measured in 1e-09 minutes; give the search more time\n"
    )
    assert not Path("mine.toml").exists()


def test_a_real_ctrl_c_ends_a_search_and_leaves_its_file(short: str) -> None:
    line = f"calibrate --search --scenario {short} --candidates 100000 --out mine.toml"
    command = [sys.executable, "-m", "workbench", *line.split()]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment())
    assert process.stderr is not None
    assert process.stderr.readline().startswith("best so far: candidate 1")
    os.kill(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert load_scenario("mine.toml").name == "mine"
