"""What this machine's launcher, commands and pages make of a run that belongs to a cluster; no Ray is needed."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from workbench import launcher
from workbench.engine import LocalEngine
from workbench.launcher import drain, stop_now
from workbench.run_index.record import read_record
from workbench.run_state import RunState
from workbench.runs import Run, RunBusyError, RunStore


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


@pytest.fixture
def run(store: RunStore) -> Run:
    return store.create(TrainingConfig(profile="smoke"), engine="ray")


def test_a_clusters_run_waits_only_while_its_command_lives_and_is_never_started_here(
    store: RunStore, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launcher, "_start", lambda _run: pytest.fail("it was started here"))
    lock = run.claim()
    assert lock is not None
    assert run.state.state == "queued" and drain(store) == []
    record = read_record(run.path, run.id, False)
    assert (record.state, record.running) == ("queued", 1), "the index has to look again whether it lives"
    with pytest.raises(RunBusyError):
        LocalEngine(store).resume(run)
    os.close(lock)
    assert run.state.state == "interrupted" and run.state.resumable and drain(store) == []


def test_its_cores_are_not_counted_here(store: RunStore, run: Run) -> None:
    lock = run.claim()
    assert lock is not None
    assert LocalEngine(store, workers=2).free() == 2
    os.close(lock)


def test_to_end_it_at_once_kills_nobody_here(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "kill", lambda *_: pytest.fail("a process of this machine was killed"))
    lock = run.claim()
    assert lock is not None
    run.write_state(dataclasses.replace(run.state, state="running", pid=os.getpid()))
    stop_now(run)
    assert run.stop_requested() and run.end_requested()
    os.close(lock)


def test_a_run_says_where_it_works_and_how_often_it_was_begun_again() -> None:
    assert RunState("running").where == ""
    assert RunState("queued", engine="ray").where == "waits for a node"
    assert RunState("running", engine="ray", node="lab7 (a1b2c3)").where == "lab7 (a1b2c3)"
    again = RunState("running", engine="ray", node="lab7 (a1b2c3)", retries=2)
    assert again.where == "lab7 (a1b2c3), begun again 2 times"
