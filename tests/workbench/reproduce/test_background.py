"""Reproductions in the background: begun once, told about, stopped; nothing of the kind twice at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from workbench.reproduce import background
from workbench.reproduce.background import Order, beginning, failure, start, stop
from workbench.reproduce.job import BusyError, Job, read_job, working
from workbench.reproduce.seed_counts import SeedCounts
from workbench.runs import RunStore

PATIENCE_S = 60.0
HERE = Path(__file__).parent
ORDER = Order("fig9", "smoke", SeedCounts(2, 3, 1), 50)


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A runs folder; `workbench reproduce` is a stand-in that does what the file `told.txt` says."""
    monkeypatch.setattr(background, "ENTRY", (str(HERE / "fake_reproduce.py"),))
    root = tmp_path / "runs"
    root.mkdir()
    yield root
    for child in background._children.values():
        child.kill()
        child.wait()
    background._children.clear()


def wait_for(met: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not met():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def alive(root: Path) -> bool:
    job = read_job(root, "trainings")
    return job is not None and job.alive


def test_it_is_the_command_with_the_runs_and_a_place_for_its_results(root: Path) -> None:
    assert ORDER.arguments(root, root / "results") == [
        "reproduce", "fig9", "--profile", "smoke", "--seeds", "2", "--seeds-submas", "3", "--seeds-baselines", "1",
        "--episodes", "50", "--runs", str(root), "--out", str(root / "results"),
    ]  # fmt: skip


def test_one_begins_works_and_is_stopped(root: Path) -> None:
    start(root, root / "results", ORDER)
    assert beginning(root, "trainings")
    with pytest.raises(BusyError, match="wait for it or stop it"):
        start(root, root / "results", ORDER)
    wait_for(lambda: alive(root))
    assert not beginning(root, "trainings")
    with pytest.raises(BusyError):
        start(root, root / "results", ORDER)
    # Another kind is not hindered.
    assert not beginning(root, "flights")
    assert stop(RunStore(root), "trainings") is not None
    wait_for(lambda: not alive(root))
    job = read_job(root, "trainings")
    assert job is not None and job.state == "interrupted"
    assert stop(RunStore(root), "trainings") is None
    assert failure(root, "trainings") == ""


@pytest.mark.parametrize(("error", "state"), [(KeyboardInterrupt(), "interrupted"), (ValueError("broken"), "failed")])
def test_how_it_ended_is_told_whatever_comes(root: Path, error: BaseException, state: str) -> None:
    job = Job(items=("fig9",), profile="smoke", command="c", results="r", pid=1)
    with pytest.raises(type(error)), working(root, "trainings", job):
        raise error
    last = read_job(root, "trainings")
    assert last is not None and last.state == state


def test_one_that_cannot_begin_says_why(root: Path) -> None:
    (root / "told.txt").write_text("refuse")
    start(root, root / "results", ORDER)
    wait_for(lambda: not beginning(root, "trainings"))
    assert failure(root, "trainings") == "the scenario is broken"
    assert read_job(root, "trainings") is None
