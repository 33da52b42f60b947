"""`workbench reproduce`: what it refuses, what it prints, and one small reproduction with nothing faked."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.workbench.reproduce.samples import made
from workbench import cli
from workbench.commands import reproduce
from workbench.commands.reproduce import Args, results_folder
from workbench.reproduce import eta, protocol
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.session import Report, Session


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("table4 --engine cloud", "--engine is 'cloud'; legal are local, ray"),
        ("table4 --seeds 0", "--seeds is 0; legal are 1 to 100, the number of trainings of each algorithm"),
        (
            "table4 --seeds-baselines 101",
            "--seeds-baselines is 101; legal are 1 to 100, the number of trainings of each algorithm",
        ),
        ("table4 --episodes 0", "--episodes is 0; legal are 1 to 1000000"),
        ("fig8 --profile slow", "profile 'slow' is unknown; choose paper, fast, smoke"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_code_2(
    line: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["reproduce", *line.split(), "--out", "results"]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", f"workbench: {sentence}\n")
    assert not list(Path().iterdir())


def test_an_unknown_item_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["reproduce", "fig10"]) == 2
    assert "fig10" in capsys.readouterr().err


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> dict[str, Report]:
    """What sessions report instead of working, under `report`."""
    reports: dict[str, Report] = {}
    monkeypatch.setattr(Session, "run", lambda *_: reports["report"])
    return reports


def results(*sets: ResultSet) -> dict[str, ResultSet]:
    return {one.item: one for one in sets}


@pytest.mark.parametrize(
    ("interrupted", "failures", "code"), [(False, (), 0), (False, ("it broke",), 1), (True, (), 130)]
)
def test_exit_codes(told: dict[str, Report], interrupted: bool, failures: tuple[str, ...], code: int) -> None:
    told["report"] = Report(results(made("fig13")), interrupted, failures)
    Path("results/fast").mkdir(parents=True)
    assert cli.main(["reproduce", "fig13", "--out", "results"]) == code


def test_the_json_is_one_object(told: dict[str, Report], capsys: pytest.CaptureFixture[str]) -> None:
    told["report"] = Report(results(made("table4", seeds=2, without=("sac",)), made("fig13")), False, ("it broke",))
    Path("results/fast").mkdir(parents=True)
    assert cli.main(["reproduce", "all", "--out", "results", "--json"]) == 1
    printed = json.loads(capsys.readouterr().out)
    assert (printed["failures"], printed["interrupted"]) == (["it broke"], False)
    assert printed["items"]["fig13"]["files"] == ["results/fast/fig13.json", "results/fast/fig13.png"]
    assert (printed["items"]["fig13"]["complete"], printed["items"]["table4"]["complete"]) == (True, False)
    (first, *_) = printed["items"]["fig13"]["points"]
    assert set(first) == {"says", "where", "here", "holds"}


def test_tables_points_and_notes_are_shown(told: dict[str, Report], capsys: pytest.CaptureFixture[str]) -> None:
    told["report"] = Report(results(made("table4", seeds=2)), False, ("it broke",))
    Path("results/fast").mkdir(parents=True)
    cli.main(["reproduce", "table4", "--out", "results"])
    out, err = capsys.readouterr()
    assert "Table 4: all algorithms on the target task" in out and "466.3, 94.8 %" in out
    assert "the paper says" in out and "Seeds trained, of 2 asked for" in out
    assert err == "workbench: warning: it broke\n"
    assert Path("results/fast/report.md").read_text().startswith("# Reproduction")


def test_where_result_sets_go(monkeypatch: pytest.MonkeyPatch) -> None:
    checkout = reproduce.__file__.partition("/workbench/")[0]
    assert results_folder(Args("fig13")) == Path(checkout) / "assets/results"
    assert results_folder(Args("fig13", profile="smoke")) == Path("runs/results")
    assert results_folder(Args("fig13", out=Path("there"))) == Path("there")
    monkeypatch.setattr("workbench.reproduce.places.ROOT", Path("nowhere"))
    assert results_folder(Args("fig13", runs=Path("mine"))) == Path("mine/results")


def test_what_is_left_is_shared_by_the_cores() -> None:
    assert eta.left_s([100.0, 100.0, 100.0, 100.0], 2, 0.0) == 200.0
    assert eta.left_s([100.0, 10.0], 8, 0.0) == 100.0  # a training is not shared
    assert eta.left_s([], 2, 40.0) == 40.0
    assert eta.left_s([], 2, 0.0) == 0.0


def test_a_small_reproduction_with_nothing_faked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    # Only TD3, from scratch: the shortest training there is.
    only = {**protocol.TRAINED_FOR, "fig9": ("td3",)}
    for module in ("plan", "pictures", "drawings", "scorecard"):
        monkeypatch.setattr(f"workbench.reproduce.{module}.TRAINED_FOR", only)
    line = ["reproduce", "fig9", "--profile", "smoke", "--seeds", "2", "--episodes", "8", "--json"]
    assert cli.main(line) == 0
    printed, err = capsys.readouterr()
    item = json.loads(printed)["items"]["fig9"]
    assert (item["trainings"], item["numbers"], item["complete"]) == (2, 2, True)
    assert item["files"] == ["runs/results/smoke/fig9.json", "runs/results/smoke/fig9.png"]
    assert "TD3 seed 1 is trained" in err and "TD3 seed 0, target task: success" in err and "left" in err
    kept = (tmp_path / "runs/results/smoke/fig9.json").read_bytes()
    number = json.loads(kept)["numbers"][0]
    # The command beside a number gives that number.
    assert cli.main([*number["command"].split()[1:], "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["success_rate"] == number["success_rate"]
    assert again["mean_return"] == pytest.approx(number["mean_return"], abs=0.01)
    # And a second time there is nothing to do.
    assert cli.main(line) == 0
    assert (tmp_path / "runs/results/smoke/fig9.json").read_bytes() == kept
    assert capsys.readouterr().err == ""
