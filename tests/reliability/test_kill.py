"""R1: a training that is killed at any moment and resumed is the training that was never interrupted, bit for bit.

`KILLS=50 pytest tests/reliability/test_kill.py` kills fifty times; every push kills five times.
"""

from __future__ import annotations

import dataclasses
import json
import os
import random
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from safetensors.numpy import load_file

from agents import numerics
from agents.config import TrainingConfig
from tests.reliability.small_training import EPOCHS, learn, one_route
from workbench import launcher
from workbench.launcher import launch, resume
from workbench.recorder import RunRecorder
from workbench.runs import Run, RunStore

ENTRY = Path(__file__).with_name("small_training.py")
KILLS = int(os.environ.get("KILLS", "5"))
TIMES = ("wall_s", "cpu_s", "eta_s", "updates_per_s", "env_steps_per_s")
PATIENCE_S = 120.0
TRAININGS = {
    "submas curriculum": (TrainingConfig(curriculum=True, missiles=2, seed=1), 2, KILLS),
    "td3": (TrainingConfig(missiles=2, variant="td3", seed=1), 1, 1),
    "sac": (TrainingConfig(missiles=1, variant="sac", seed=1), 1, 1),
    "ppo": (TrainingConfig(missiles=1, variant="ppo", seed=1), 1, 1),
}
"""By name: what is trained, in how many stages, and how often it is killed."""


@pytest.fixture(autouse=True)
def _real_learner(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(launcher, "ENTRY", (str(ENTRY),))
    monkeypatch.setattr(numerics, "choose_matmul_route", one_route)


@pytest.mark.parametrize("name", TRAININGS)
def test_a_killed_and_resumed_training_is_the_uninterrupted_one(name: str, store: RunStore) -> None:
    config, stages, kills = TRAININGS[name]
    chance = random.Random(f"{name} {kills}")
    whole, run = uninterrupted(store, config), launch(store, config)
    # With a single kill, one from which there is something to go on.
    earliest = 0.0 if kills > 1 else 2.0
    moments = sorted(chance.uniform(earliest, stages * EPOCHS - 1.5) for _ in range(kills))
    for moment in moments:
        kill(run, moment, chance)
        resume(store, run)
        if moment == moments[0] and stages > 1:  # and once more, while it comes back
            time.sleep(chance.uniform(0.0, 1.0))
            strike(run)
            resume(store, run)
    await_end(run)
    assert run.state.resumes >= kills
    resumed = [event["text"] for event in run.events() if event["kind"] == "resumed"]
    assert resumed[-1].startswith("resumed at checkpoint")
    assert rows(run) == rows(whole)
    assert len(rows(run)) == stages * EPOCHS
    assert told(run) == told(whole)
    assert_same_policies(run, whole)
    assert not (run.path / "checkpoints").exists()


def uninterrupted(store: RunStore, config: TrainingConfig) -> Run:
    """The same training, all in this process."""
    run = store.create(config)
    recorder = RunRecorder(run, dataclasses.replace(run.state, state="running"))
    learn(run, store, recorder, recorder.resume())
    recorder.end("finished")
    return run


def kill(run: Run, moment: float, chance: random.Random) -> None:
    """Kill the run when so many epochs and a part of one are done; at once if it is further already."""
    deadline = time.monotonic() + PATIENCE_S
    while len(run.metrics()) < int(moment):
        assert time.monotonic() < deadline and run.state.active, f"{run.state}; {run.log_tail()}"
        time.sleep(0.001)
    time.sleep(chance.uniform(0.0, 0.05))
    strike(run)


def strike(run: Run) -> None:
    """SIGKILL its whole process group; it shows as interrupted within two seconds (R9)."""
    deadline = time.monotonic() + PATIENCE_S
    while run.state.pid is None:
        assert time.monotonic() < deadline, run.log_tail()
        time.sleep(0.001)
    os.killpg(run.state.pid, signal.SIGKILL)
    struck = time.monotonic()
    while run.state.state == "running":
        assert time.monotonic() < struck + 2.0
        time.sleep(0.001)
    assert run.state.state == "interrupted", f"{run.state}; {run.log_tail()}"


def await_end(run: Run) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while run.state.active or run.is_alive():
        assert time.monotonic() < deadline, f"{run.state}; {run.log_tail()}"
        time.sleep(0.02)
    assert run.state.state == "finished", f"{run.state}; {run.log_tail()}"


def rows(run: Run) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name not in TIMES} for row in run.metrics()]


def told(run: Run) -> list[str]:
    return [event["text"] for event in run.events() if event["kind"] != "resumed"]


def assert_same_policies(run: Run, whole: Run) -> None:
    names = sorted(path.name for path in (whole.path / "policies").glob("*.safetensors"))
    assert names == sorted(path.name for path in (run.path / "policies").glob("*.safetensors")) and names
    for name in names:
        ours, theirs = load_file(run.path / "policies" / name), load_file(whole.path / "policies" / name)
        assert ours.keys() == theirs.keys()
        for part, array in ours.items():
            np.testing.assert_array_equal(array, theirs[part])
        assert card(run.path / "policies" / name) == card(whole.path / "policies" / name)


def card(path: Path) -> dict[str, Any]:
    found = json.loads(path.with_suffix(".json").read_text())
    found["evaluation"].pop("env_steps_per_s")
    return found
