"""The run store: folders are the truth, one bad run never hides the others, ids are checked before any path is made."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from workbench.run_files import LineReader, RunFileError, append_line, take_lock, write_json
from workbench.run_state import RunState
from workbench.runs import Run, RunBusyError, RunsFolderError, RunStore, UnknownRunError


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


def test_a_new_run_is_queued_and_holds_its_configuration(store: RunStore) -> None:
    config = TrainingConfig(curriculum=True, profile="smoke", seed=3, name="mine")
    run = store.create(config)
    assert RunStore(store.root).get(run.id).config == config
    assert run.state.state == "queued"
    assert [each.id for each in store.list()] == [run.id]
    assert (run.metrics(), run.events(), run.policy_path()) == ([], [], None)


def test_the_newest_run_comes_first(store: RunStore) -> None:
    shutil.copytree(store.create(TrainingConfig()).path, store.root / "20200101-000000-aaaaaa")
    shutil.copytree(store.list()[0].path, store.root / "20990101-000000-aaaaaa")
    assert [run.id[:4] for run in store.list()][0::2] == ["2099", "2020"]


def test_no_runs_folder_is_no_runs(store: RunStore) -> None:
    assert store.list() == []


FAULTS: dict[str, Callable[[Path], object]] = {
    "config is not JSON": lambda run: (run / "config.json").write_text("{"),
    "config is missing": lambda run: (run / "config.json").unlink(),
    "config has an unknown key": lambda run: write_json(run / "config.json", {"command": "rm -rf"}),
    "config has a wrong type": lambda run: write_json(run / "config.json", {"seed": "zero"}),
    "config is a list": lambda run: (run / "config.json").write_text("[]"),
    "config is enormous": lambda run: (run / "config.json").write_bytes(b" " * 2**20),
    "config is a folder": lambda run: ((run / "config.json").unlink(), (run / "config.json").mkdir()),
    "config is binary": lambda run: (run / "config.json").write_bytes(bytes(range(256))),
    "state holds NaN": lambda run: (run / "state.json").write_text('{"state": "running", "progress": NaN}'),
    "state is unknown": lambda run: write_json(run / "state.json", {"state": "dancing"}),
    "state has a wrong type": lambda run: write_json(run / "state.json", {"state": "failed", "stage": "x"}),
    "state is empty": lambda run: (run / "state.json").write_text(""),
    "state is deeply nested": lambda run: (run / "state.json").write_text("[" * 100_000),
    "a file, not a folder": lambda run: (shutil.rmtree(run), run.write_text("")),
    "a dangling link": lambda run: (shutil.rmtree(run), run.symlink_to("/nowhere")),
    "a link out of the folder": lambda run: (shutil.rmtree(run), run.symlink_to("/")),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_one_bad_run_never_hides_the_others(fault: str, store: RunStore) -> None:
    # R6, and what MLflow's users report again and again.
    good, bad = store.create(TrainingConfig()), store.create(TrainingConfig())
    FAULTS[fault](bad.path)
    listed = {run.id: run for run in RunStore(store.root).list()}
    assert listed[good.id].problem == ""
    assert listed[bad.id].problem
    assert len(listed[bad.id].problem) < 300


def test_a_bad_run_is_good_again_once_it_is_mended(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    whole = (run.path / "config.json").read_text()
    (run.path / "config.json").write_text("{")
    assert store.get(run.id).problem
    (run.path / "config.json").write_text(whole)
    assert store.get(run.id).problem == ""


HOSTILE_IDS = (
    "", ".", "..", "../runs-evil", "%2e%2e", "%252e", "..\\x", "/etc/passwd", "//", "a\0b", "C:", "x" * 5000,
    "20250101-000000-AAAAAA",
    "20250101-000000-aaaaa", "20250101-000000-aaaaaa/", "20250101-000000-aaaaaa\n", "20250101-000000-aaaaaa/../x",
    "２0250101-000000-aaaaaa", "20250101∕000000-aaaaaa", "*", "[a-z]*", ".trash", "~", "$HOME",
)  # fmt: skip


@pytest.mark.parametrize("run_id", HOSTILE_IDS)
@pytest.mark.parametrize("ask", ["get", "delete", "restore"])
def test_only_an_id_ever_becomes_a_path(run_id: str, ask: str, store: RunStore) -> None:
    # S8: refused by its form, before the disk is touched (the runs folder does not even exist).
    with pytest.raises(UnknownRunError, match="is not a run id") as refused:
        getattr(store, ask)(run_id)
    assert len(str(refused.value)) < 300
    assert not store.root.exists()


def test_an_unknown_run_is_a_sentence(store: RunStore) -> None:
    with pytest.raises(UnknownRunError, match=r"20250101-000000-aaaaaa is not in .*runs"):
        store.get("20250101-000000-aaaaaa")


def test_a_deleted_run_is_in_the_trash_whole(store: RunStore) -> None:
    run = store.create(TrainingConfig(name="keep me"))
    moved = store.delete(run.id)
    assert moved == store.root / ".trash" / run.id
    assert json.loads((moved / "config.json").read_text())["name"] == "keep me"
    assert store.list() == []


def test_a_deleted_run_comes_back_whole(store: RunStore) -> None:
    run = store.create(TrainingConfig(name="keep me"))
    before = {path.name: path.read_bytes() for path in run.path.iterdir() if path.is_file()}
    store.delete(run.id)
    assert [each.id for each in store.trashed()] == [run.id]
    back = store.restore(run.id)
    assert {path.name: path.read_bytes() for path in back.path.iterdir() if path.name in before} == before
    assert store.list() == [back]
    assert store.trashed() == []


def test_of_two_deleted_under_one_id_the_later_comes_back_and_the_other_stays(store: RunStore) -> None:
    run = store.create(TrainingConfig(name="first"))
    copy = store.root / "copy"
    shutil.copytree(run.path, copy)
    store.delete(run.id)
    write_json(copy / "config.json", TrainingConfig(name="second").to_json())
    copy.rename(run.path)
    with pytest.raises(RunBusyError, match="cannot be restored: a run of this id is in"):
        store.restore(run.id)
    store.delete(run.id)
    assert len(store.trashed()) == 2
    assert store.restore(run.id).config.name == "second"
    assert [each.config.name for each in store.trashed()] == ["first"]


def test_only_emptying_the_trash_removes_for_good_and_only_what_is_a_run(store: RunStore, tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "file").write_text("x")
    kept, gone, link = (store.create(TrainingConfig()) for _ in range(3))
    shutil.rmtree(link.path)
    link.path.symlink_to(precious)
    for run in (gone, link):
        store.delete(run.id)
    mine = store.root / ".trash" / "mine.txt"
    mine.write_text("not a run")
    half_removed = store.root / ".trash" / f".leaving-{kept.id}"
    half_removed.mkdir()
    assert store.empty_trash() == 3
    assert sorted(path.name for path in (store.root / ".trash").iterdir()) == ["mine.txt"]
    assert (precious / "file").read_text() == "x"
    assert [run.id for run in store.list()] == [kept.id]
    assert store.empty_trash() == 0


def test_what_is_not_in_the_trash_cannot_come_back(store: RunStore) -> None:
    with pytest.raises(UnknownRunError, match="is not in the trash"):
        store.restore("20250101-000000-aaaaaa")


def test_a_link_is_deleted_and_not_what_it_points_to(store: RunStore, tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    run = store.create(TrainingConfig())
    shutil.rmtree(run.path)
    run.path.symlink_to(precious)
    store.delete(run.id)
    assert precious.is_dir()
    assert store.list() == []


def test_a_running_run_cannot_be_deleted(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    lock = run.claim()
    assert lock is not None
    with pytest.raises(RunBusyError, match="is running; stop it"):
        store.delete(run.id)
    os.close(lock)
    store.delete(run.id)


def test_a_finished_run_cannot_be_stopped(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    run.write_state(RunState("finished"))
    with pytest.raises(RunBusyError, match="is not running: it is finished"):
        run.request_stop()


def test_a_runs_folder_that_cannot_be_made_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RunsFolderError, match=r"runs folder .*file/runs cannot be written \(.*\); choose another"):
        RunStore(tmp_path / "file" / "runs").create(TrainingConfig())


def test_a_torn_last_line_is_not_yet(tmp_path: Path) -> None:
    # R15, after TensorBoard: cut the last byte, read, complete it, read.
    path = tmp_path / "metrics.jsonl"
    for epoch in range(3):
        append_line(path, {"epoch": epoch})
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    reader = LineReader(path)
    assert [row["epoch"] for row in reader.read_new()] == [0, 1]
    assert reader.read_new() == []
    path.write_bytes(whole)
    assert [row["epoch"] for row in reader.read_new()] == [2]


@pytest.mark.parametrize("cut", range(1, 12))
def test_a_reader_never_sees_half_a_row(cut: int, tmp_path: Path) -> None:
    path = tmp_path / "metrics.jsonl"
    append_line(path, {"epoch": 0})
    append_line(path, {"epoch": 1})
    path.write_bytes(path.read_bytes()[:-cut])
    assert [row["epoch"] for row in LineReader(path).read_new()] == [0]


def test_a_torn_line_in_the_middle_is_an_error_of_that_run(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    (run.path / "metrics.jsonl").write_text('{"epoch": 1}\n{"epo\n{"epoch": 3}\n')
    with pytest.raises(RunFileError, match=r"metrics.jsonl, line 2 is not JSON"):
        run.metrics()


def test_an_endless_line_is_refused_without_reading_it_all(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    with (run.path / "metrics.jsonl").open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(RunFileError, match="line 1 is longer than"):
        run.metrics()


def test_numbers_that_are_not_finite_are_written_as_null(tmp_path: Path) -> None:
    append_line(tmp_path / "x.jsonl", {"a": float("nan"), "b": [float("inf")], "c": 1.0})
    assert (tmp_path / "x.jsonl").read_text() == '{"a":null,"b":[null],"c":1.0}\n'


def test_a_write_that_fails_leaves_the_old_content_and_no_temporary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "state.json"
    write_json(path, {"state": "old"})

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(RunFileError, match=r"cannot save .*state.json: No space left on device"):
        write_json(path, {"state": "new"})
    assert json.loads(path.read_text()) == {"state": "old"}
    assert list(tmp_path.iterdir()) == [path]


def test_a_run_that_says_running_without_a_process_is_interrupted(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    run.write_state(RunState("running", pid=os.getpid()))
    assert run.state.state == "interrupted"
    lock = take_lock(run.path / "run.lock")
    assert lock is not None
    assert run.state.state == "running"
    os.close(lock)


def test_the_signature_changes_with_everything_a_page_shows(store: RunStore) -> None:
    run = store.create(TrainingConfig())
    seen = {run.signature()}
    append_line(run.path / "metrics.jsonl", {"epoch": 1})
    seen.add(run.signature())
    append_line(run.path / "events.jsonl", {"kind": "best"})
    seen.add(run.signature())
    run.write_state(RunState("running"))
    seen.add(run.signature())
    lock = run.claim()
    seen.add(run.signature())
    assert len(seen) == 5
    assert run.signature() in seen
    os.close(lock or 0)


def test_known_runs_are_not_parsed_again(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    store.create(TrainingConfig())
    store.list()
    monkeypatch.setattr(Run, "write_state", None)
    monkeypatch.setattr("workbench.run_folder.read_json", _never)
    assert len(store.list()) == 1


def _never(path: Path) -> dict[str, object]:
    raise AssertionError(f"{path} was read again")
