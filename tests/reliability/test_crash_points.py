"""Whatever step of writing a crash falls on, the run goes on as if nothing had happened (R2, R7, R8).

The steps are not sampled but enumerated, after SQLite: crash at the first, the second, … until the run gets through.
"""

from __future__ import annotations

import contextlib
import errno
import math
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from tests.reliability.failing_disk import (
    CountingDisk,
    Death,
    KilledDisk,
    PowerCutDisk,
    RefusingDisk,
    ReorderingDisk,
    SmallDisk,
    installed,
)
from tests.reliability.in_process import content, events, files, metrics, revive, train
from workbench import pulse
from workbench.checkpoints import Checkpoints
from workbench.run_files import RunFileError
from workbench.runs import Run, RunStore

NAME = "epochs=4 epoch_s=0"


@pytest.fixture(autouse=True)
def _save_every_epoch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pulse, "SAVING_SHARE", math.inf)
    # Nothing here depends on what survives a real power failure.
    monkeypatch.setattr("os.fsync", lambda descriptor: None)


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


def new_run(store: RunStore) -> Run:
    return store.create(TrainingConfig(profile="smoke", name=NAME))


@pytest.fixture
def whole(store: RunStore) -> Run:
    """The run that nothing interrupts."""
    run = new_run(store)
    train(run, store)
    return run


def assert_same(run: Run, whole: Run) -> None:
    assert metrics(run) == metrics(whole)
    assert events(run) == events(whole)
    assert content(run) == content(whole)
    assert files(run) == files(whole)


def assert_has_a_checkpoint(run: Run) -> None:
    """From the second epoch on there is always a whole one, until the run is over."""
    if len(metrics(run)) > 1 and run.state.state != "finished":
        assert Checkpoints(run.path / "checkpoints", run.id).latest() is not None


@pytest.mark.parametrize("kind", [KilledDisk, PowerCutDisk, ReorderingDisk])
def test_a_crash_at_any_step_of_a_run_leaves_a_run_that_goes_on(
    kind: type[KilledDisk], store: RunStore, whole: Run
) -> None:
    for at in range(1, 10_000):
        run = new_run(store)
        died = False
        with installed(kind(at)):
            try:
                train(run, store)
            except Death:
                died = True
        assert_has_a_checkpoint(run)
        revive(run)
        if not died:
            break
        train(run, store)
        assert_same(run, whole)
        shutil.rmtree(run.path)
    assert at > 50, "there are more steps than that"


def test_two_crashes_in_a_row_are_survived_too(store: RunStore, whole: Run) -> None:
    for at in range(1, 120, 7):
        run = new_run(store)
        for later in (60, at):
            with installed(PowerCutDisk(later)), contextlib.suppress(Death):
                train(run, store)
            revive(run)
        train(run, store)
        assert_same(run, whole)


def test_a_step_that_is_refused_is_an_error_and_never_silence(store: RunStore, whole: Run) -> None:
    # R8: a save that did not happen ends the run (Lightning's issue 21800: training went on, no file existed).
    run, counting = new_run(store), CountingDisk()
    with installed(counting):
        train(run, store)
    for at in range(1, counting.steps + 1):
        run = new_run(store)
        with installed(RefusingDisk(at, errno.EACCES)), pytest.raises((RunFileError, OSError)):
            train(run, store)
        assert not [name for name in files(run) if name.endswith(".tmp")]
        revive(run)
        train(run, store)
        assert_same(run, whole)
        shutil.rmtree(run.path)


def capacities(store: RunStore) -> Iterator[int]:
    size = sum(path.stat().st_size for path in store.root.rglob("*") if path.is_file())
    return iter(range(size + 600, size + 9_000, 700))


def test_a_full_disk_fails_the_run_and_space_lets_it_go_on(store: RunStore, whole: Run) -> None:
    # R7
    failed = 0
    for capacity in capacities(store):
        run = new_run(store)
        with installed(SmallDisk(store.root, capacity)):
            try:
                train(run, store)
            except (RunFileError, OSError) as error:
                failed += 1
                assert "No space left on device" in str(error)
                for path in run.path.glob("*.jsonl"):
                    assert path.read_bytes()[-1:] in (b"", b"\n"), "half a line would swallow the next"
                assert not [name for name in files(run) if name.endswith(".tmp")]
        revive(run)
        train(run, store)
        assert_same(run, whole)
        shutil.rmtree(run.path)
    assert failed >= 5
