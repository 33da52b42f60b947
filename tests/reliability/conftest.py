"""Run folders with trainings that are real processes around a fake learner."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from workbench import launcher
from workbench.runs import Run, RunStore

FAKE = Path(__file__).with_name("fake_training.py")
PATIENCE_S = 30.0


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunStore]:
    """An empty runs folder whose trainings are fake; none outlives the test."""
    monkeypatch.setattr(launcher, "ENTRY", (str(FAKE),))
    store = RunStore(tmp_path / "runs")
    yield store
    for run in store.list():
        pid = run.state.pid if run.path.is_dir() else None
        if pid and pid != os.getpid() and run.is_alive():
            os.kill(pid, signal.SIGKILL)
    for child in launcher._children:
        child.kill()
        child.wait()
    launcher._children.clear()


@pytest.fixture
def config() -> Callable[..., TrainingConfig]:
    """A training configuration whose name tells the fake learner what to do."""
    return lambda name="", seed=0: TrainingConfig(profile="smoke", name=name, seed=seed)


@pytest.fixture
def wait() -> Callable[[Run, str], None]:
    """Wait until a run is in a state."""
    return wait_for_state


def wait_for_state(run: Run, state: str) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while run.state.state != state:
        assert time.monotonic() < deadline, f"{run.id} is {run.state}, not {state}; {run.log_tail()}"
        time.sleep(0.01)
