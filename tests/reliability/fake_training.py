"""A training process that learns nothing, quickly: the real entry point around a stand-in for the learner.

What it does is told by the run's name: `epochs=5 epoch_s=0.1 fail_at=3 nan_at=2 die_at=4 hang_at=2
saving=0 (the share of its time that goes into checkpoints; 0: only the first and what is needed)
struck_at_end=1` (two signals arrive while it writes how it ended).
"""

from __future__ import annotations

import math
import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from agents.snapshot import Snapshot
from workbench import launcher, pulse, training
from workbench.recorder import RunRecorder
from workbench.runs import Run, RunStore


def learn(run: Run, store: RunStore, recorder: RunRecorder, snapshot: Snapshot | None) -> None:
    told = dict(part.split("=") for part in run.config.name.split())
    epochs, epoch_s = int(told.get("epochs", 3)), float(told.get("epoch_s", 0.01))
    pulse.SAVING_SHARE = float(told.get("saving", pulse.SAVING_SHARE))
    began = time.monotonic()
    if "struck_at_end" in told:
        recorder.end = lambda state, error="": struck(recorder, state, error)
    if snapshot is None:
        recorder.event("stage_started", "stage 1 of 1: target")
    for epoch in range(1 if snapshot is None else int(snapshot.values["epoch"]) + 1, epochs + 1):
        if epoch == int(told.get("fail_at", 0)):
            raise ValueError("the learner is broken")
        if epoch == int(told.get("die_at", 0)):
            os.kill(os.getpid(), signal.SIGKILL)
        if epoch == int(told.get("hang_at", 0)) and snapshot is None:
            time.sleep(600.0)
        time.sleep(epoch_s)
        loss = math.nan if epoch == int(told.get("nan_at", 0)) else 1.0 / epoch
        recorder.epoch(metrics_row(epoch, epochs, loss, time.monotonic() - began))
        weights = np.full(3, math.nan if epoch == int(told.get("weights_nan_at", 0)) else float(epoch))
        taken = Snapshot(0, {"epoch": epoch}, {"learner/actor": weights}, Slots(epoch))
        recorder.checkpoint(lambda taken=taken: taken)
        if recorder.should_stop():
            return


def struck(recorder: RunRecorder, state: str, error: str) -> None:
    """End a run while somebody presses Ctrl-C again and again."""
    os.kill(os.getpid(), signal.SIGTERM)
    os.kill(os.getpid(), signal.SIGINT)
    RunRecorder.end(recorder, state, error)


class Slots:
    """Experience of a fake learner: one row of two numbers per epoch, in a ring of four."""

    def __init__(self, added: int) -> None:
        self.added = added

    def blocks(self, first: int) -> Iterator[tuple[int, np.ndarray]]:
        first = max(first, self.added - 4)
        if first < self.added:
            yield first, np.arange(2 * first, 2 * self.added, dtype=np.float32).reshape(-1, 2)


def metrics_row(epoch: int, epochs: int, critic_loss: float = 0.1, wall_s: float = 1.0) -> dict[str, object]:
    """One row as the learner reports it."""
    return {
        "stage": 0, "stages": 1, "task": "target", "missiles": [1, 2, 3, 4], "epoch": epoch, "epochs": epochs,
        "env_steps": 100 * epoch, "updates": 10 * epoch, "alpha": 0.9, "epsilon": 0.5, "beta": 0.1,
        "return_mean": 10.0 * epoch, "success_rate": epoch / epochs if epoch % 2 == 0 else None,
        "train_success_rate": epoch / epochs, "train_return_mean": 9.0 * epoch, "length_mean_s": 900.0,
        "transfer_share": 0.7, "critic_loss": critic_loss, "actor_loss": -0.1, "q_mean": 1.0,
        "updates_per_s": 100.0, "env_steps_per_s": 1000.0, "wall_s": wall_s, "eta_s": 0.5 * (epochs - epoch),
    }  # fmt: skip


if __name__ == "__main__":
    pulse.LEAST_PATIENCE_S = 0.5
    pulse.SAVING_SHARE = math.inf
    launcher.ENTRY = (str(Path(__file__).resolve()),)
    training._learn = learn
    sys.exit(training.main())
