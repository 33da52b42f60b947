"""What a node streams home is at every moment a run folder from which the run can go on; nothing else gets in."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agents.config import TrainingConfig
from agents.snapshot import Snapshot
from tests.reliability.fake_training import Slots, metrics_row
from workbench.checkpoints import Checkpoints
from workbench.cluster.receiver import ForeignNameError, GivenUpError, RunReceiver
from workbench.cluster.run_agent import Order, attempt
from workbench.cluster.run_mirror import RunMirror
from workbench.recorder import RunRecorder
from workbench.runs import Run, RunStore

LAST = 3
"""Epochs: with the third, the first checkpoint is removed."""


class LineCutError(Exception):
    """The node is gone."""


class Head:
    """The receiver without a cluster between; the line is cut after so many messages."""

    def __init__(self, receiver: RunReceiver, run: Run, number: int = 1, most: float = float("inf")) -> None:
        self._receiver, self._run, self._number, self._left = receiver, run, number, most
        self.messages = 0

    def call(self, method: str, *values: Any) -> Any:
        if self.messages >= self._left:
            raise LineCutError
        self.messages += 1
        return getattr(self._receiver, method)(self._run.id, self._number, *values)


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "head")


@pytest.fixture
def run(store: RunStore) -> Iterator[Run]:
    """A run that waits, its lock held as an engine holds it."""
    with claimed(store) as run:
        yield run


@contextlib.contextmanager
def claimed(store: RunStore) -> Iterator[Run]:
    run = store.create(TrainingConfig(profile="smoke"), engine="ray")
    lock = run.claim()
    assert lock is not None
    yield run
    os.close(lock)


def receiver(store: RunStore, run: Run, number: int = 1) -> RunReceiver:
    made = RunReceiver(str(store.root))
    made.expect(run.id, number)
    return made


def node_folder(tmp_path: Path, run: Run) -> Path:
    folder = tmp_path / "node" / run.id
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def epoch(recorder: RunRecorder, number: int) -> None:
    """An epoch as a training writes it: a row, an event, a policy, a checkpoint."""
    recorder.epoch(metrics_row(number, 6))
    recorder.event("best", f"epoch {number}")
    (recorder.run.path / "policies/target.safetensors").write_bytes(bytes([number]) * 50)
    snapshot = Snapshot(0, {"epoch": number}, {"learner/actor": np.full(3, float(number))}, Slots(number))
    recorder.checkpoint(lambda: snapshot)


def train(folder: Path, mirror: RunMirror, last: int) -> None:
    """Train to this epoch, sending after each; the folder goes on where it is."""
    run = Run(folder)
    recorder = RunRecorder(run, dataclasses.replace(run.state, state="running"))
    found = recorder.resume()
    for number in range(1 if found is None else int(found.values["epoch"]) + 1, last + 1):
        epoch(recorder, number)
        mirror.send(last=True)
    mirror.send(last=True)


def test_after_any_message_the_head_can_go_on_and_ends_with_the_same_files(
    store: RunStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("workbench.pulse.SAVING_SHARE", float("inf"))
    reached: list[tuple[int, int]] = []
    cut, whole = 0, False
    while not whole:
        cut += 1
        with claimed(store) as run:
            whole = train_until_cut(store, run, tmp_path, cut)
            found = Checkpoints(run.path / "checkpoints", run.id).latest()
            assert not found or found.refused == ()
            reached.append((found.snapshot.values["epoch"] if found else 0, len(run.metrics())))
            if not whole:
                go_on(store, run, tmp_path)
        shutil.rmtree(run.path)
    checkpoints = [checkpoint for checkpoint, _ in reached]
    assert checkpoints == sorted(checkpoints) and {*checkpoints} == set(range(LAST + 1))
    assert all(rows >= checkpoint for checkpoint, rows in reached)


def train_until_cut(store: RunStore, run: Run, tmp_path: Path, most: int) -> bool:
    """Train on a node whose line is cut after so many messages; whether they were enough."""
    head, folder = Head(receiver(store, run), run, most=most), node_folder(tmp_path, run)
    try:
        assert head.call("begin", "node 1")
        mirror = RunMirror(folder, head)
        mirror.fetch()
        (folder / "policies").mkdir(exist_ok=True)
        train(folder, mirror, LAST)
    except LineCutError:
        return False
    return True


def go_on(store: RunStore, copy: Run, tmp_path: Path) -> None:
    """The next attempt, on another node, from what the head has."""
    copy.write_state(dataclasses.replace(copy.state, state="queued", retries=1))
    head = Head(receiver(store, copy, 2), copy, 2)
    assert head.call("begin", "node 2")
    folder = node_folder(tmp_path, copy)
    mirror = RunMirror(folder, head)
    mirror.fetch()
    (folder / "policies").mkdir(exist_ok=True)
    train(folder, mirror, LAST)
    assert [row["epoch"] for row in copy.metrics()] == list(range(1, LAST + 1))
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if path.is_file() and path.name not in ("state.json", "run.lock"):
            assert (copy.path / name).read_bytes() == path.read_bytes(), name
    names = {path.name for path in (copy.path / "checkpoints").iterdir()}
    assert names == {path.name for path in (folder / "checkpoints").iterdir()}


def test_an_attempt_that_was_given_up_writes_nothing_more(store: RunStore, run: Run) -> None:
    taking = receiver(store, run, 1)
    assert taking.begin(run.id, 1, "node 1")
    taking.expect(run.id, 2)
    for method, values in (("append", ("metrics.jsonl", 0, b"x\n")), ("put", ("policy.json", 0, b"x", True))):
        with pytest.raises(GivenUpError, match="attempt 1"):
            getattr(taking, method)(run.id, 1, *values)
    assert not (run.path / "metrics.jsonl").exists() and not (run.path / "policy.json").exists()


@pytest.mark.parametrize(
    "name",
    ["../stolen.jsonl", "/etc/passwd", "run.lock", "config.json", "state.json", "policies/../config.json", "stop",
     "policies/.x.json", "checkpoints/manifest-1.json", "checkpoints/../../x", "notes.json", "policies/a/b.json"],
)  # fmt: skip
def test_only_files_that_a_training_writes_come_in(name: str, store: RunStore, run: Run) -> None:
    taking = receiver(store, run)
    with pytest.raises(ForeignNameError):
        taking.put(run.id, 1, name, 0, b"x", True)
    with pytest.raises(ForeignNameError):
        taking.append(run.id, 1, name, 0, b"x")
    with pytest.raises(ForeignNameError):
        taking.read(run.id, 1, name if name not in ("config.json", "state.json") else "stop", 0, 1)


def test_the_state_is_told_by_the_heads_clock_and_keeps_what_the_head_decides(store: RunStore, run: Run) -> None:
    taking = receiver(store, run)
    assert taking.begin(run.id, 1, "node 1")
    told = dataclasses.replace(run.state, pid=4711, beat_s=1e9, engine="", node="elsewhere", retries=9, progress=0.5)
    taking.state(run.id, 1, told.to_json())
    written = json.loads((run.path / "state.json").read_text())
    assert (written["pid"], written["engine"], written["node"], written["retries"]) == (None, "ray", "node 1", 0)
    assert written["progress"] == 0.5 and written["beat_s"] < 1e9
    assert run.state.state == "running"


def test_a_run_that_was_stopped_while_it_waited_never_begins(store: RunStore, run: Run) -> None:
    run.write_state(dataclasses.replace(run.state, state="stopped"))
    assert not receiver(store, run).begin(run.id, 1, "node 1")


def order(run: Run, **more: Any) -> Order:
    values = {"run": run.id, "attempt": 1, "folder": str(run.path), "folders": "auto", "proof": "",
              "entry": ("-c", "raise SystemExit(3)"), "versions": {}, "guide": {}}  # fmt: skip
    return Order(**{**values, **more})


def test_a_node_with_another_version_or_without_the_shared_folder_refuses(store: RunStore, run: Run) -> None:
    head = Head(receiver(store, run), run)
    said = attempt(head, order(run, versions={"torch": "0.1"}), "node 1").refused
    assert said.startswith("node 1 would train something else: it has torch ") and said.endswith("instead of 0.1")
    said = attempt(head, order(run, folders="shared"), "node 1").refused
    assert said == f"node 1 does not see {run.path}; use --run-folders streamed"
    assert run.state.state == "queued"


def test_a_guide_that_is_a_file_travels_and_the_nodes_folder_is_removed(store: RunStore, run: Run) -> None:
    script = (
        "import sys, pathlib as p; f = p.Path(sys.argv[1]); (f / 'log.txt').write_bytes((f / 'guide.x').read_bytes())"
    )
    told = order(run, entry=("-c", script), guide={"guide.x": b"told"})
    assert attempt(Head(receiver(store, run), run), told, "node 1").exit_code == 0
    assert (run.path / "log.txt").read_bytes() == b"told" and not (run.path / "guide.x").exists()
