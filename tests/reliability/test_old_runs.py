"""R17: what earlier versions wrote is listed, opened, flown and resumed by today's code, or refused in a sentence."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from agents.policy import bind
from sim.task import task_for
from sim.trajectory import fly
from workbench import cli, launcher
from workbench.checkpoint_manifest import SCHEMA, read_manifest
from workbench.launcher import resume
from workbench.policies import resolve_policy
from workbench.recordings import Recordings
from workbench.run_index.file import NAME
from workbench.run_index.index import RunIndex
from workbench.run_index.query import RunSearch
from workbench.run_index.record import read_record
from workbench.runs import RunStore

GOLDEN = Path(__file__).parents[1] / "golden"
FIRST, SAVED, KILLED = "20261123-001448-42v9l6", "20261123-001458-85wtfv", "20261123-005850-hjr36i"
EVERY = (FIRST, SAVED, KILLED)


@pytest.fixture
def old(tmp_path: Path) -> RunStore:
    """A runs folder with a copy of every old run, and the index that was beside them."""
    shutil.copytree(GOLDEN / "runs", tmp_path / "runs")
    shutil.copyfile(GOLDEN / "first-index.sqlite", tmp_path / "runs" / NAME)
    return RunStore(tmp_path / "runs")


def test_every_old_run_is_listed(old: RunStore) -> None:
    runs = old.list()
    assert [(run.id, run.problem) for run in runs] == [(name, "") for name in reversed(EVERY)]
    assert [run.state.state for run in runs] == ["interrupted", "finished", "finished"]


@pytest.mark.parametrize("name", EVERY)
def test_all_there_is_to_know_of_an_old_run_is_there(name: str, old: RunStore) -> None:
    run = old.get(name)
    record = read_record(run.path, run.id, trashed=False)
    assert record.problem == "" and record.title.startswith("golden")
    assert (record.profile == "smoke" and record.seed == "0") or record.seed == 0
    assert [row["epoch"] for row in run.metrics()] == [1, 2]
    assert "stage_started" in [event["kind"] for event in run.events()]
    assert run.policy_missiles() == (1,)


@pytest.mark.parametrize("arguments", [["list"], ["list", "--json"], ["show"], ["show", "--json"]], ids=" ".join)
def test_the_commands_tell_of_old_runs(arguments: list[str], old: RunStore, capsys: pytest.CaptureFixture[str]) -> None:
    for name in EVERY if arguments[0] == "show" else [""]:
        assert cli.main(["runs", *arguments, *filter(None, [name]), "--runs", str(old.root)]) == 0
    assert "golden" in capsys.readouterr().out


@pytest.mark.parametrize("name", EVERY)
def test_an_old_policy_flies(name: str, old: RunStore, tmp_path: Path) -> None:
    policy, task = resolve_policy(name, old), task_for("default", "2,3,4")
    flight = fly(task, bind(policy, task), policy.name, 1)
    assert flight.duration_s > 10.0
    recordings = Recordings(tmp_path / "rrd")
    assert (recordings.folder / recordings.compare({"an old policy": flight})).stat().st_size > 10_000


def test_an_old_index_is_made_anew_and_nothing_is_lost(old: RunStore) -> None:
    index = RunIndex(old.root)
    index.look()
    assert [record.id for record in index.find(RunSearch())] == list(reversed(EVERY))
    assert [record.title for record in index.find(RunSearch(text="killed"))] != []
    assert index.notice == "" or "made anew" in index.notice or "rebuilt" in index.notice


def test_an_old_checkpoint_is_resumed_to_the_end(old: RunStore) -> None:
    # By a real process with the real learner: the folder of a training that was killed after its first epoch.
    run = old.get(KILLED)
    assert read_manifest(run.path / "checkpoints", 1, run.id).schema <= SCHEMA
    before = run.metrics()
    resume(old, run)
    for child in launcher._children:
        child.wait(timeout=300)
    assert run.state.state == "finished" and run.state.resumes == 1, run.log_tail()
    kinds = [event["kind"] for event in run.events()]
    assert "resumed" in kinds and kinds[-1] == "finished"
    assert [row["epoch"] for row in run.metrics()] == [1, 2]
    assert run.metrics()[0] == before[0], "what the checkpoint holds is not made again"


@pytest.mark.parametrize(
    ("file", "change", "words"),
    [
        ("config.json", {"colour": "red"}, "unknown key 'colour' in a training configuration"),
        ("config.json", {"profile": "turbo"}, "profile 'turbo' is unknown; choose paper, fast, smoke"),
        ("config.json", {"missiles": "four"}, "missiles is 'four'; a int is needed"),
        ("state.json", {"state": "dreaming"}, "state 'dreaming' is none of queued"),
        ("state.json", {"wall_s": "long"}, "wall_s is 'long'"),
    ],
)
def test_what_a_later_version_wrote_is_a_sentence(
    file: str, change: dict[str, object], words: str, old: RunStore, capsys: pytest.CaptureFixture[str]
) -> None:
    path = old.root / FIRST / file
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    by_name = {run.id: run.problem for run in old.list()}
    assert words in by_name[FIRST] and by_name[SAVED] == by_name[KILLED] == ""
    assert cli.main(["runs", "--runs", str(old.root)]) == 0
    assert words.split()[0] in capsys.readouterr().out


def test_what_a_later_version_adds_to_a_state_is_passed_over(old: RunStore) -> None:
    path = old.root / FIRST / "state.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "mood": "good", "heat_K": [300.0]}))
    assert old.get(FIRST).state.state == "finished"


def test_a_policy_for_other_observations_says_to_train_it_again(
    old: RunStore, capsys: pytest.CaptureFixture[str]
) -> None:
    path = old.root / FIRST / "policy.safetensors"
    content = path.read_bytes()
    digest = json.loads((old.root / FIRST / "policy.json").read_text())["layout_digest"].encode()
    path.write_bytes(content.replace(digest, b"0" * len(digest)))
    assert cli.main(["fly", FIRST, "--mask", "2,3,4", "--runs", str(old.root)]) == 2
    assert "made for other observations than this version's; train it again" in capsys.readouterr().err
