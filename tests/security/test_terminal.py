"""S9: whatever a name, a note, an event, a path or an argument says, the terminal shows it and obeys nothing."""

from __future__ import annotations

import ast
import dataclasses
import json
import shutil
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from tests.security.hostile import EVERY, PRINTABLE, STEERING, steers
from tests.security.hostile_runs import fill, policy_file, scenario_file
from tests.security.sources import calls, trees
from workbench import cli
from workbench.cluster.ray_engine import RayEngine, _Task
from workbench.progress import bar
from workbench.runs import RunStore
from workbench.terminal import print_json, print_line, print_table

TALKERS = {
    "terminal.py": "the home of what is printed",
    "server.py": "its own address",
    "export_job.py": "numbers and an error, read by the export menu",
    "speed_probe.py": "numbers, read by the pages",
    "training.py": "into the run's log",
}
"""Modules that may print past `workbench.terminal`, and what."""
SAYS = ("print", "sys.stdout.write", "sys.stderr.write")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("hostile") / "runs"
    fill(root)
    return root


def heard(capsys: pytest.CaptureFixture[str]) -> str:
    told = capsys.readouterr()
    return told.out + told.err


@pytest.mark.parametrize("text", EVERY, ids=range(len(EVERY)))
def test_lines_tables_and_json_steer_nothing(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_line(text)
    print_line(text, error=True)
    print_table(("name", text), [(text, "1")], title=text)
    with bar(text) as progress:
        progress.say(text)
    assert steers(heard(capsys)) == []
    print_json({"name": text, text: [text]})
    said = capsys.readouterr().out
    assert steers(said) == []
    assert json.loads(said) == {"name": text, text: [text]}


@pytest.mark.parametrize("arguments", [["list"], ["list", "--json"], ["trash"]], ids=" ".join)
def test_the_lists_of_runs_steer_nothing(
    folder: Path, arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["runs", *arguments, "--runs", str(folder)]) == 0
    assert steers(heard(capsys)) == []


def test_a_run_that_is_shown_steers_nothing_and_says_it_all(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for run in RunStore(folder).list():
        for also in ([], ["--json"]):
            assert cli.main(["runs", "show", run.id, "--runs", str(folder), *also]) == 0
    told = heard(capsys)
    assert steers(told) == []
    assert "\\x1b[31mred" in told, "the escape is shown, not swallowed"


def test_a_run_in_markup_is_not_painted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["runs", "list", "--runs", str(folder)]) == 0
    assert "[bold red]markup[/]" in capsys.readouterr().out


COMMANDS = [
    ["fly", "{}"], ["fly", "random", "--scenario", "{}"], ["fly", "random", "--mask", "{}"],
    ["fly", "random", "--out", "{}.csv"], ["evaluate", "{}"], ["evaluate", "random", "--scenario", "{}.toml"],
    ["study", "{}"], ["train", "--name", "{}", "--profile", "{}"], ["train", "--guide", "{}"],
    ["train", "--seeds", "{}"], ["train", "--curriculum", "--order", "{}"], ["train", "--variant", "{}"],
    ["resume", "{}"], ["stop", "{}"], ["pause", "{}"], ["runs", "show", "{}"], ["runs", "delete", "{}"],
    ["runs", "restore", "{}"], ["calibrate", "--scenario", "{}"], ["runs", "list", "{}"], ["serve", "--host", "{}"],
]  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_refused_argument_steers_nothing(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for text in (*STEERING, *PRINTABLE[:4], "x" * 5000, "~nobody/x.safetensors", "a" * 300 + ".safetensors"):
        if "\x00" in text:
            continue  # no argument of a process holds one
        given = [word.format(text.replace("{", "").replace("}", "")) for word in command]
        if given[-1].startswith("-"):
            continue
        code = cli.main([*given, *([] if command[0] in ("calibrate",) else ["--runs", str(tmp_path / "runs")])])
        assert code in (1, 2) or "--out" in given, given
        told = heard(capsys)
        assert steers(told.split("╭")[0]) == [], given
        assert "Traceback" not in told and len(told) < 20_000
    assert not (tmp_path / "stolen").exists()


@pytest.mark.parametrize("name", ["[bold]Ugly[/] =1+1 <b>", "名前 %s {0}"])
def test_policies_and_scenarios_with_such_names_fly(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    policy = policy_file(tmp_path / "p.safetensors", name)
    scenario = scenario_file(tmp_path / "s.toml", name)
    assert cli.main(["fly", str(policy), "--scenario", str(scenario), "--mask", "2"]) == 0
    told = heard(capsys)
    assert name in told and steers(told) == []


@pytest.mark.parametrize("text", STEERING, ids=range(len(STEERING)))
def test_files_with_names_that_steer_are_refused_in_a_sentence(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for suffix in ("safetensors", "toml"):
        clean = "".join(c for c in text if c not in "\x00\udc80/")
        path = tmp_path / f"{clean}.{suffix}"
        shutil.copyfile(__file__, path)
        command = ["fly", str(path)] if suffix == "safetensors" else ["fly", "random", "--scenario", str(path)]
        assert cli.main(command) == 2
        told = heard(capsys)
        assert steers(told) == [] and told.startswith("workbench: ") and told.count("\n") == 1


def test_what_a_node_says_of_its_death_steers_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # The reason is an error of another machine, and the node's name is its own.
    run = RunStore(tmp_path).create(TrainingConfig(profile="smoke", missiles=1), engine="ray")
    engine = RayEngine.__new__(RayEngine)
    monkeypatch.setattr(RayEngine, "_hand_over", lambda *_: None)
    for text in STEERING:
        run.write_state(dataclasses.replace(run.state, state="running", node=text.encode("utf-8", "replace").decode()))
        engine._begin_again(_Task(run, 0, 1, None), text)
    told = heard(capsys)
    assert steers(told) == [] and "\\x1b[31mred" in told and told.count("\n") == len(STEERING)


def test_only_one_module_prints() -> None:
    found = set()
    for path, tree in trees("workbench").items():
        said = [node for node in calls(tree) if ast.unparse(node.func) in SAYS and path.name not in TALKERS]
        found |= {f"{path.name} line {node.lineno}" for node in said if not all(map(_constant, node.args))}
    assert found == set()


def _constant(argument: ast.expr) -> bool:
    return not any(isinstance(part, ast.Name) for part in ast.walk(argument))
