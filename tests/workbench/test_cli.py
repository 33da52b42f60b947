"""The command line: exit codes, one sentence per mistake, JSON alone on standard output, help for everything."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from agents.config import TrainingConfig
from workbench import cli
from workbench.launcher import environment
from workbench.runs import RunStore


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("damaged.safetensors").write_bytes(b"\x80\x04not a policy")
    Path("empty.safetensors").write_bytes(b"")
    Path("file").write_text("")


MISTAKES = [
    ("fly expert-dragging --mask 5", "mask names missile 5; legal are 1 to 4"),
    ("fly expert-dragging --mask 0,1", "mask names missile 0; legal are 1 to 4"),
    ("fly expert-dragging --mask x", "mask 'x' is not a list of missiles"),
    ("fly nobody", "policy 'nobody' is unknown; use one of: expert-dragging"),
    ("evaluate nobody", "policy 'nobody' is unknown"),
    ("fly missing.safetensors", "policy file 'missing.safetensors' does not exist"),
    ("fly damaged.safetensors", "policy file 'damaged.safetensors' is damaged"),
    ("evaluate empty.safetensors", "policy file 'empty.safetensors' is damaged"),
    ("fly 20250101-000000-aaaaaa", "run 20250101-000000-aaaaaa is not in"),
    ("fly random --out flight.xyz", "--out flight.xyz ends in '.xyz'; legal are .acmi, .csv, .gif, .html, .mp4"),
    ("fly random --out flight", "--out flight has no suffix"),
    ("fly random --seed -1", "--seed is -1; it must not be negative"),
    ("evaluate random --episodes 0", "--episodes is 0; legal are 1 to"),
    ("evaluate random --scenario nowhere", "nowhere"),
    ("fly random --scenario nowhere", "no scenario 'nowhere'; there are default, long-range-ramjet"),
    ("fly random --scenario short-range --mask 3", "mask names missile 3; legal are 1 to 2"),
    ("fly submas-target --scenario six-missiles", "cannot see missiles 5, 6 of this task; mask them (--mask 5,6)"),
    ("evaluate submas-source-2 --scenario six-missiles --mask 6", "mask them (--mask 3,4,5)"),
    ("train --missiles 7 --scenario six-missiles", "--missiles is 7; legal are 1 to 6"),
    ("train --missiles 3 --scenario six-missiles", "choose one with --guide, or train the whole chain"),
    ("train --curriculum --missiles 2", "give one of them"),
    ("train --missiles 0", "--missiles is 0; legal are 1 to 4"),
    ("train --missiles 5", "--missiles is 5; legal are 1 to 4"),
    ("train --missiles 1 --guide nobody", "policy 'nobody' is unknown"),
    ("train --missiles 1 --variant dqn", "variant 'dqn' is unknown"),
    ("train --missiles 1 --profile quick", "profile 'quick' is unknown; choose paper, fast, smoke"),
    ("train --missiles 1 --seeds one", "seeds 'one' is not a list of at most 100 seeds"),
    ("train --missiles 1 --seeds 4-0", "seeds '4-0' is not a list of at most"),
    ("train --missiles 1 --seeds 0-99999999999", "is not a list of at most 100 seeds"),
    ("runs show", "needs a run id"),
    ("runs show ../../etc", "'../../etc' is not a run id"),
    ("runs delete 20250101-000000-aaaaaa", "run 20250101-000000-aaaaaa is not in"),
    ("runs list 20250101-000000-aaaaaa", "takes no run"),
    ("stop nothing", "'nothing' is not a run id"),
    ("calibrate --episodes 0", "--episodes is 0"),
]


@pytest.mark.parametrize(("line", "sentence"), MISTAKES, ids=[line for line, _ in MISTAKES])
def test_a_mistake_is_one_sentence_and_exit_code_2(
    line: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(line.split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("workbench: ")
    assert sentence in err
    assert err.count("\n") == 1


FAILURES = [
    ("fly random --out nowhere/x.csv", "--out nowhere/x.csv: there is no folder nowhere"),
    ("train --missiles 1 --profile smoke --runs file/runs", "cannot be written (Not a directory); choose another"),
    ("runs --runs file", "cannot be read"),
]


@pytest.mark.parametrize(("line", "sentence"), FAILURES, ids=[line for line, _ in FAILURES])
def test_a_failure_is_one_sentence_and_exit_code_1(
    line: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(line.split()) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("workbench: ")
    assert sentence in err


@pytest.mark.parametrize("line", ["dance", "fly", "fly a b", "runs dance", "fly random --speed 3", "stop"])
def test_a_line_that_cannot_be_read_is_exit_code_2(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(line.split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err


def named(args: type) -> Iterator[dataclasses.Field[Any]]:
    """The arguments as a person types them; those of a group stand beside the others."""
    hints = get_type_hints(args)
    for field in dataclasses.fields(args):
        if dataclasses.is_dataclass(group := hints[field.name]):
            yield from dataclasses.fields(group)
        else:
            yield field


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_every_command_explains_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([name, "--help"]) == 0
    shown = capsys.readouterr().out
    args = cli.command(name).Args
    assert f"usage: workbench {name}" in shown
    assert args.__doc__
    for field in named(args):
        option = field.name if field.default is dataclasses.MISSING else f"--{field.name.replace('_', '-')}"
        assert option in shown or option.upper() in shown or option.lstrip("-") in ("action", "run", "policy")


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_every_argument_is_described(name: str) -> None:
    import ast

    path = Path(str(cli.command(name).__file__))
    body = next(n for n in ast.parse(path.read_text()).body if isinstance(n, ast.ClassDef) and n.name == "Args").body
    for statement, following in zip(body, [*body[1:], None], strict=True):
        if isinstance(statement, ast.AnnAssign):
            assert isinstance(following, ast.Expr), f"{name}: {ast.unparse(statement)} has no description"


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"]) == 0
    shown = capsys.readouterr().out
    for name in cli.COMMANDS:
        assert f"• {name} " in shown


def test_help_comes_at_once_and_loads_no_heavy_library() -> None:
    code = (
        "import sys; from workbench.cli import main; main(['--help']);"
        "heavy = {'torch', 'panel', 'warp', 'rerun', 'viser', 'bokeh', 'matplotlib'};"
        "sys.exit(','.join(sorted(heavy & set(sys.modules))))"
    )
    began = time.monotonic()
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, env=environment())
    assert ended.stderr.strip() == ""
    assert time.monotonic() - began < 5.0


def test_no_command_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    served: list[object] = []
    module = cli.command("serve")
    monkeypatch.setattr(module, "run", lambda args: served.append(args) or 0)
    assert cli.main([]) == 0
    assert cli.main(["--port", "6000", "--no-browser"]) == 0
    assert [args.port for args in served] == [5006, 6000]


def test_ctrl_c_is_exit_code_130(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli.command("runs"), "run", interrupted)
    assert cli.main(["runs"]) == 130
    assert capsys.readouterr().err == "workbench: interrupted\n"


def test_fly_shows_the_engagement(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fly", "expert-navigation", "--mask", "1,2,3,4", "--seed", "3"]) == 0
    shown = capsys.readouterr().out
    assert "expert-navigation on source-4, seed 3" in shown
    assert "exit reached" in shown
    assert "time [s]" in shown


def test_fly_json_is_one_object(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fly", "expert-navigation", "--mask", "3,4", "--json"]) == 0
    flown = json.loads(capsys.readouterr().out)
    assert (flown["mask"], flown["missiles"]) == ([3, 4], [1, 2])
    assert [one["missile"] for one in flown["missile_fates"]] == [1, 2]
    assert {"outcome", "return", "length_s", "events"} <= set(flown)


def test_fly_writes_a_table_of_every_instant(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fly", "expert-dragging", "--mask", "2,3,4", "--out", "flight.csv", "--json"]) == 0
    length_s = json.loads(capsys.readouterr().out)["length_s"]
    header, *rows = Path("flight.csv").read_text().splitlines()
    assert header.startswith("time_s,evader_x_m,evader_y_m,evader_z_m,evader_heading_rad")
    assert "missile_1_azimuth_rad" in header
    assert "missile_2" not in header
    assert float(rows[-1].split(",")[0]) == pytest.approx(length_s)
    assert {len(row.split(",")) for row in rows} == {len(header.split(","))}


EVALUATION_KEYS = {
    "policy", "mask", "missiles", "scenario", "episodes", "seed", "success_rate", "success_ci95", "mean_return",
    "mean_length_s", "outcomes", "missiles_evaded_mean", "env_steps_per_s",
}  # fmt: skip


def test_evaluate_json_holds_what_is_promised(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "random", "--mask", "1,2", "--episodes", "8", "--seed", "5", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert set(figures) >= EVALUATION_KEYS
    assert sum(figures["outcomes"].values()) == figures["episodes"] == 8
    assert (figures["mask"], figures["missiles"], figures["seed"]) == ([1, 2], [3, 4], 5)


def test_evaluate_shows_the_interval(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "expert-navigation", "--mask", "1,2,3,4", "--episodes", "4"]) == 0
    shown = capsys.readouterr().out
    assert "expert-navigation on source-4: 4 engagements, seed 0" in shown
    assert "success" in shown


def test_runs_lists_shows_and_deletes(capsys: pytest.CaptureFixture[str]) -> None:
    run = RunStore("runs").create(TrainingConfig(name="my \x1b[31mrun".replace("\x1b", "")))
    assert cli.main(["runs"]) == 0
    assert run.id in capsys.readouterr().out
    assert cli.main(["runs", "--json"]) == 0
    assert [one["id"] for one in json.loads(capsys.readouterr().out)["runs"]] == [run.id]
    assert cli.main(["runs", "show", run.id, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["config"]["name"] == "my [31mrun"
    assert cli.main(["runs", "delete", run.id]) == 0
    assert ".trash" in capsys.readouterr().out
    assert RunStore("runs").list() == []


def test_runs_come_back_from_the_trash_until_it_is_emptied(capsys: pytest.CaptureFixture[str]) -> None:
    run = RunStore("runs").create(TrainingConfig())
    RunStore("runs").delete(run.id)
    assert cli.main(["runs", "trash", "--json"]) == 0
    assert [one["id"] for one in json.loads(capsys.readouterr().out)["runs"]] == [run.id]
    assert cli.main(["runs", "restore", run.id]) == 0
    assert f"run {run.id} is back" in capsys.readouterr().out
    assert cli.main(["runs", "delete", run.id]) == 0
    assert cli.main(["runs", "empty-trash", "--json"]) == 0
    assert '"removed": 1' in capsys.readouterr().out
    assert RunStore("runs").trashed() == []


def test_a_damaged_run_is_listed_with_its_reason(capsys: pytest.CaptureFixture[str]) -> None:
    store = RunStore("runs")
    good, bad = store.create(TrainingConfig()), store.create(TrainingConfig())
    (bad.path / "config.json").write_text("{\x1b[2J")
    assert cli.main(["runs"]) == 0
    shown = capsys.readouterr().out
    assert good.id in shown
    assert "config.json is not JSON" in shown
    assert "\x1b[2J" not in shown


def test_stop_takes_a_queued_run_out_of_the_queue(capsys: pytest.CaptureFixture[str]) -> None:
    run = RunStore("runs").create(TrainingConfig())
    assert cli.main(["stop", run.id, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"id": run.id, "state": "stopped", "stop_requested": True}
    assert cli.main(["stop", run.id]) == 1
    assert "is not running: it is stopped" in capsys.readouterr().err
