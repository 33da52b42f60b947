"""A training process that learns nothing, quickly: the real entry point around a stand-in for the learner.

The file `told.json` in the runs folder says what becomes of a training: {"td3 0": "fail"}, also "die" and "wait".
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from pathlib import Path

from sim.scenario_file import load_scenario
from workbench import launcher, training
from workbench.recorder import RunRecorder
from workbench.runs import Run, RunStore

EPOCHS = 2


def learn(run: Run, store: RunStore, recorder: RunRecorder, snapshot: object) -> None:
    config, told = run.config, json.loads((store.root / "told.json").read_text())
    word = told.get(f"{config.variant} {config.seed}")
    tasks = ("source-3", "source-2", "source-1", "target") if config.curriculum else ("target",)
    if word == "fail":
        raise ValueError("the learner is broken")
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    for stage, task in enumerate(tasks):
        for epoch in range(1, EPOCHS + 1):
            recorder.epoch(row(stage, len(tasks), task, epoch, 0.1 * config.seed + 0.05 * epoch))
        path = run.path / "policies" / f"{task}.safetensors"
        path.write_text(f"{config.variant} {config.seed} {task}")
    (run.path / "policy.json").write_text(json.dumps({"scenario_digest": load_scenario().digest}))
    while word == "wait" and not (store.root / "go").exists():
        time.sleep(0.02)


def row(stage: int, stages: int, task: str, epoch: int, success: float) -> dict[str, object]:
    return {
        "stage": stage, "stages": stages, "task": task, "epoch": epoch, "epochs": EPOCHS, "env_steps": 1000 * epoch,
        "success_rate": success, "return_mean": 100.0 * success, "wall_s": 0.5 * epoch, "eta_s": 1.0,
    }  # fmt: skip


launcher.ENTRY = (str(Path(__file__).resolve()),)
training._learn = learn

if __name__ == "__main__":
    sys.exit(training.main())
