"""Waiting for what a cluster does, and looking at its processes."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import psutil

from workbench.engine import Engine
from workbench.runs import Run

PATIENCE_S = 400.0


def await_(engine: Engine, done: Callable[[], bool], *runs: Run) -> None:
    """Keep the engine moving until something is so."""
    deadline = time.monotonic() + PATIENCE_S
    while not done():
        failed = any(run.state.state == "failed" for run in runs)
        assert time.monotonic() < deadline and not failed, [(run.state, run.log_tail()) for run in runs]
        engine.tick()
        time.sleep(0.02)


def await_ends(engine: Engine, *runs: Run) -> None:
    """Until the runs have ended and nobody holds them."""
    await_(engine, lambda: not any(run.state.active or run.is_alive() for run in runs), *runs)


def trainings(run: Run) -> list[psutil.Process]:
    """The training processes of a run that this process or one of its children started, wherever their folder is."""
    return [process for process in psutil.Process().children(recursive=True) if _trains(process, run)]


def _trains(process: psutil.Process, run: Run) -> bool:
    try:
        words = process.cmdline()
    except psutil.Error:
        return False  # it has ended since it was listed
    return "--held" in words and any(word.endswith(f"/{run.id}") for word in words)


def kill_worker(run: Run) -> None:
    """SIGKILL Ray's worker that looks after a run's training; the training must not outlive it."""
    (training,) = trainings(run)
    parent = training.parent()
    assert parent is not None and parent.name().startswith("ray::"), parent
    os.kill(parent.pid, signal.SIGKILL)
    psutil.wait_procs([training], timeout=PATIENCE_S)
    assert not training.is_running()


def kill_training(run: Run) -> None:
    """SIGKILL the training process itself."""
    (training,) = trainings(run)
    os.kill(training.pid, signal.SIGKILL)
