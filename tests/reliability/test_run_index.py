"""The index finds what the folders say, follows them, and is made anew whatever happens to its file (R5, R6)."""

from __future__ import annotations

import dataclasses
import os
import random
import shutil
import sqlite3
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from tests.reliability.test_runs import FAULTS
from workbench.bench.runs import make_runs
from workbench.run_files import write_json
from workbench.run_index.file import NAME, VERSION
from workbench.run_index.index import RunIndex
from workbench.run_index.query import FACETS, SORTS, RunSearch
from workbench.run_index.record import UNREADABLE, RunRecord
from workbench.run_notes import RunNotes, write_notes
from workbench.run_state import RunState
from workbench.runs import RunStore

COUNT = 60


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


@pytest.fixture
def made(store: RunStore) -> RunStore:
    make_runs(store.root, COUNT, epochs=4)
    return store


def _index(store: RunStore) -> RunIndex:
    index = RunIndex(store.root)
    index.look()
    return index


def test_it_lists_what_the_folders_say(made: RunStore) -> None:
    records = {record.id: record for record in _index(made).find()}
    runs = made.list()
    assert len(runs) == COUNT
    assert list(records) == [run.id for run in runs]
    for run in runs:
        record, config, state = records[run.id], run.config, run.state
        assert (record.name, record.seed, record.variant) == (config.name, config.seed, config.variant)
        assert (record.state, record.success) == (state.state, state.best_success_rate)
        rows = run.metrics()
        last_of_stages = {row["stage"]: row["env_steps"] for row in rows}
        assert (record.epochs, record.steps) == (rows[-1]["epoch"], sum(last_of_stages.values()))


def _by_hand(records: list[RunRecord], search: RunSearch) -> set[str]:
    """The same search as plain Python."""
    kept = set()
    for record in records:
        words = search.text.lower().split()
        said = all((word[1:] not in record.haystack) if word[0] == "-" else word in record.haystack for word in words)
        has = {name: {getattr(record, name)} for name in FACETS if name != "tag"} | {"tag": set(record.tag_list)}
        if said and all(has[name] & set(values) for name, values in search.chosen.items() if values):
            kept.add(record.id)
    return kept


@pytest.mark.parametrize(
    "search",
    [
        RunSearch("bench-0007"),
        RunSearch("SUBMAS seed"),
        RunSearch("bench -submas"),
        RunSearch("note 1"),
        RunSearch("%"),
        RunSearch("' OR 1=1 --"),
        RunSearch(chosen={"state": ("failed", "stopped")}),
        RunSearch(chosen={"variant": ("wo-pd",), "profile": ("fast",)}),
        RunSearch("bench", {"tag": ("keep", "odd"), "task": ("Curriculum 1–4",)}),
        RunSearch(chosen={"scenario": ("x' OR 'a'='a",)}),
    ],
    ids=lambda search: f"{search.text} {dict(search.chosen)}",
)
def test_a_search_finds_what_python_finds(search: RunSearch, made: RunStore) -> None:
    # S13: parameters only; the same answer as a filter that knows no SQL.
    index = _index(made)
    found = [record.id for record in index.find(search)]
    assert set(found) == _by_hand(index.find(), search)
    assert index.count(search) == len(found)
    assert [record.id for record in index.find(search, first=2, most=3)] == found[2:5]


@pytest.mark.parametrize("sort", [key for name in SORTS for key in (name, f"-{name}")])
def test_every_order_is_an_order_and_what_is_unknown_comes_last(sort: str, made: RunStore) -> None:
    bare = made.create(TrainingConfig())
    records = _index(made).find(RunSearch(sort=sort))
    assert len(records) == COUNT + 1
    name = sort.removeprefix("-")
    columns = {"started": "when", "return": "mean_return", "time": "wall_s"}
    values = [getattr(record, columns.get(name, name)) for record in records]
    known = [value for value in values if value is not None and (name != "name" or value)]
    if name != "task":
        assert known == sorted(known, reverse=sort.startswith("-"))
    if name in ("success", "return", "steps", "name"):
        assert records[-1].id == bare.id


def test_facets_count_runs(made: RunStore) -> None:
    index = _index(made)
    for name, counts in index.facets().items():
        for value, count in counts.items():
            assert count == index.count(RunSearch(chosen={name: (value,)}))
    assert sum(index.facets()["state"].values()) == COUNT
    assert index.facets()["tag"]


def test_a_tag_is_found_whole(made: RunStore) -> None:
    run = made.create(TrainingConfig())
    write_notes(run.path, RunNotes("", ("keepsake", "a b")))
    index = _index(made)
    assert run.id not in {record.id for record in index.find(RunSearch(chosen={"tag": ("keep",)}))}
    assert [record.id for record in index.find(RunSearch(chosen={"tag": ("a b",)}))] == [run.id]


# It follows the folders.


def test_it_hears_of_new_changed_and_deleted_runs(made: RunStore) -> None:
    index = _index(made)
    assert not index.look()
    run = made.create(TrainingConfig(name="fresh"))
    assert index.look()
    assert index.find(RunSearch("fresh"))[0].state == "queued"
    run.write_state(dataclasses.replace(run.state, state="finished", best_success_rate=0.5))
    assert index.look()
    assert index.find(RunSearch("fresh"))[0].success == 0.5
    write_notes(run.path, RunNotes("remember the milk"))
    assert index.look()
    assert index.find(RunSearch("milk"))[0].id == run.id
    made.delete(run.id)
    assert index.look()
    assert index.find(RunSearch("fresh")) == []
    assert index.find(RunSearch("fresh", trashed=True))[0].id == run.id
    made.restore(run.id)
    index.look()
    assert index.find(RunSearch("fresh"))[0].trashed == 0


def test_only_what_changed_is_read(made: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    index = _index(made)
    read: list[str] = []
    from workbench.run_index import index as run_index

    real = run_index.read_record
    monkeypatch.setattr(run_index, "read_record", lambda path, folder, trashed: (
        read.append(folder), real(path, folder, trashed))[1])  # fmt: skip
    run = made.list()[3]
    run.write_state(run.state)
    index.look()
    assert read == [run.id]
    index.close()
    index = _index(made)
    assert read == [run.id]
    assert len(index.find()) == COUNT


def test_a_file_changed_in_place_is_noticed_at_a_thorough_look(made: RunStore) -> None:
    index = _index(made)
    run = made.list()[0]
    with (run.path / "config.json").open("w") as file:
        file.write("{")
    index.look(thorough=True)
    assert index.find(RunSearch(run.id))[0].state == UNREADABLE


def test_a_dead_training_is_interrupted_and_a_living_one_runs(made: RunStore) -> None:
    run = made.create(TrainingConfig())
    lock = run.claim()
    run.write_state(RunState("running"))
    index = _index(made)
    assert index.find(RunSearch(run.id))[0].state == "running"
    os.close(lock or 0)
    assert index.look()
    assert index.find(RunSearch(run.id))[0].state == "interrupted"
    assert not index.look()


@pytest.mark.parametrize("fault", FAULTS)
def test_one_bad_run_never_hides_the_others(fault: str, made: RunStore) -> None:
    bad = made.create(TrainingConfig())
    FAULTS[fault](bad.path)
    records = {record.id: record for record in _index(made).find()}
    assert len(records) == COUNT + 1
    assert records[bad.id].state == UNREADABLE
    assert records[bad.id].problem
    assert next(iter(records)) == bad.id  # the newest comes first, damaged or not
    assert sum(bool(record.problem) for record in records.values()) == 1


@pytest.mark.parametrize(
    "metrics",
    [
        b"\x00" * 2**20,
        b"[1]\n",
        b'{"epoch": 1e400, "env_steps": true}\n',
        b'{"env_steps": 1' + b"0" * 40 + b"}\n",
        b'{"stage": {}, "env_steps": 3}\n{"stage": [1], "env_steps": null}\nx\n{"stage": 2, "env_steps": 7}\n',
    ],
)
def test_metrics_that_are_nonsense_are_no_figures(metrics: bytes, made: RunStore) -> None:
    run = made.create(TrainingConfig())
    (run.path / "metrics.jsonl").write_bytes(metrics)
    write_json(run.path / "policy.json", {"evaluation": {"mean_return": "<b>"}})
    record = _index(made).find(RunSearch(run.id))[0]
    assert (record.epochs, record.steps, record.mean_return) == (None, None, None)
    assert not record.problem


# Whatever happens to its file.


def _scribble(path: Path, start: float) -> None:
    data = bytearray(path.read_bytes())
    draw = random.Random(0)
    for place in range(int(start * len(data)), min(int(start * len(data)) + 3000, len(data))):
        data[place] = draw.randrange(256)
    path.write_bytes(bytes(data))


def _other_version(path: Path) -> None:
    database = sqlite3.connect(path)
    database.execute(f"PRAGMA user_version={VERSION - 1}")
    database.close()


def _change_a_cell(path: Path) -> None:
    database = sqlite3.connect(path)
    database.execute("UPDATE run SET name = 'not what the folder says'")
    database.commit()
    database.close()


HARMS: dict[str, Callable[[Path], object]] = {
    "missing": Path.unlink,
    "empty": lambda path: path.write_bytes(b""),
    "no database": lambda path: path.write_bytes(random.Random(0).randbytes(9000)),
    "cut in the middle": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "first page scribbled over": lambda path: _scribble(path, 0.0),
    "middle scribbled over": lambda path: _scribble(path, 0.5),
    "of another version": _other_version,
    "a cell was changed": _change_a_cell,
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "journal is garbage": lambda path: path.with_name(f"{NAME}-wal").write_bytes(random.Random(1).randbytes(40_000)),
    "shared memory is garbage": lambda path: path.with_name(f"{NAME}-shm").write_bytes(bytes(32_768)),
}


@pytest.mark.parametrize("harm", HARMS)
def test_a_harmed_index_is_made_anew_and_nothing_is_lost(harm: str, made: RunStore) -> None:
    first = _index(made)
    expected = first.find()
    first.close()
    HARMS[harm](made.root / NAME)
    index = _index(made)
    assert index.find() == expected
    assert bool(index.notice) == (harm not in ("missing", "empty", "journal is garbage", "shared memory is garbage"))
    index.close()
    if harm != "a folder":
        again = _index(made)
        assert again.find() == expected
        assert again.notice == ""


def test_an_index_that_is_taken_away_or_harmed_while_it_is_used(made: RunStore) -> None:
    index = _index(made)
    expected = index.find()
    for name in (NAME, f"{NAME}-wal", f"{NAME}-shm"):
        (made.root / name).unlink(missing_ok=True)
    index.look()
    assert index.find() == expected
    assert (made.root / NAME).is_file()
    (made.root / NAME).write_bytes(b"scribbled over while it was open" * 3000)
    index.look(thorough=True)
    index.look()
    assert index.find() == expected
    index.close()
    assert _index(made).find() == expected


def test_a_lock_is_waited_for(made: RunStore) -> None:
    _index(made).close()
    other = sqlite3.connect(made.root / NAME, check_same_thread=False, isolation_level=None)
    other.execute("PRAGMA locking_mode=EXCLUSIVE")
    other.execute("BEGIN EXCLUSIVE")
    threading.Timer(0.5, other.close).start()
    index = _index(made)
    assert len(index.find()) == COUNT
    assert index.notice == ""


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_where_nothing_can_be_written_it_is_kept_in_memory(made: RunStore) -> None:
    made.root.chmod(0o555)
    try:
        index = _index(made)
        assert len(index.find()) == COUNT
        assert "kept on disk" in index.notice
    finally:
        made.root.chmod(0o755)


def test_a_full_disk_does_not_hide_the_runs(made: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    # R7: pages open read-only.
    from workbench.run_index import file as run_index_file

    real = run_index_file.IndexFile

    def full(path: Path | None) -> run_index_file.IndexFile:
        if path is not None:
            raise sqlite3.OperationalError("database or disk is full")
        return real(path)

    monkeypatch.setattr("workbench.run_index.index.IndexFile", full)
    index = _index(made)
    assert len(index.find()) == COUNT
    assert "database or disk is full" in index.notice


def test_no_runs_folder_is_no_runs_until_there_is_one(store: RunStore) -> None:
    index = _index(store)
    assert index.find() == []
    assert not store.root.exists()
    store.create(TrainingConfig())
    assert index.look()
    assert len(index.find()) == 1
    assert (store.root / NAME).is_file()


def test_looking_from_several_threads_is_safe(made: RunStore) -> None:
    index = RunIndex(made.root)
    errors: list[BaseException] = []
    deadline = time.monotonic() + 20.0

    def work() -> None:
        try:
            for _ in range(5):
                index.look()
                index.find(RunSearch("bench"))
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(max(deadline - time.monotonic(), 0.1))
    assert errors == []
    assert len(index.find()) == COUNT


def test_text_that_is_no_unicode_is_kept_out_of_the_way(made: RunStore) -> None:
    run = made.create(TrainingConfig())
    (run.path / "state.json").write_text('{"state": "failed", "error": "\\ud800 broken"}')
    index = _index(made)
    assert index.find(RunSearch("broken"))[0].id == run.id
    shutil.rmtree(run.path)
    index.look()
    assert len(index.find()) == COUNT
