"""R9, R10, S12: the process of a training depends on nobody, and has of its launcher only what it needs."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from workbench import launcher, training
from workbench.runs import Run, RunStore

Config = Callable[..., TrainingConfig]
Wait = Callable[[Run, str], None]


def test_a_training_outlives_the_process_that_launched_it(store: RunStore, config: Config, wait: Wait) -> None:
    # R10: the launcher is killed without a chance to say goodbye.
    run = store.create(config("epochs=40 epoch_s=0.02"))
    code = (
        "import os, signal; from workbench import launcher; from workbench.runs import RunStore;"
        f"launcher.ENTRY = {launcher.ENTRY!r};"
        f"assert launcher.drain(RunStore({str(store.root)!r})); os.kill(os.getpid(), signal.SIGKILL)"
    )
    ended = subprocess.run([sys.executable, "-c", code], env=launcher.environment(), check=False)
    assert ended.returncode == -signal.SIGKILL
    assert run.state.state == "running"
    wait(run, "finished")


def test_a_ctrl_c_where_it_was_launched_does_not_reach_a_training(store: RunStore, config: Config, wait: Wait) -> None:
    # R10: a terminal sends it to every process of its foreground group; "trainings go on", says the server.
    run = store.create(config("epochs=40 epoch_s=0.02"))
    code = (
        "import os, signal; from workbench import launcher; from workbench.runs import RunStore;"
        f"launcher.ENTRY = {launcher.ENTRY!r};"
        f"assert launcher.drain(RunStore({str(store.root)!r}));"
        "signal.signal(signal.SIGINT, signal.SIG_IGN); os.killpg(0, signal.SIGINT); os.killpg(0, signal.SIGINT)"
    )
    subprocess.run([sys.executable, "-c", code], env=launcher.environment(), check=True, start_new_session=True)
    wait(run, "finished")
    assert len(run.metrics()) == 40


def test_a_training_process_gets_few_variables_and_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SECRET_TOKEN", "hush")
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Haswell")
    environment = launcher.environment()
    assert "SECRET_TOKEN" not in environment
    # Numbers are the same whichever process computes them.
    assert environment["OPENBLAS_CORETYPE"] == "Haswell"
    assert environment["OMP_NUM_THREADS"] == "1"


def test_a_training_never_forks() -> None:
    # A forked child would keep the lock of a dead trainer (R9).
    source = Path(training.__file__).read_text() + Path(launcher.__file__).read_text()
    assert "os.fork" not in source
    assert "multiprocessing" not in source
