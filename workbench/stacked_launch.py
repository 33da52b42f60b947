"""Starts one training process for several runs, which learn together (`workbench.stacked_training`)."""

from __future__ import annotations

import dataclasses
import os
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

from sim.errors import UsageError
from workbench.launcher import spawn
from workbench.run_files import waiting_lock
from workbench.run_folder import now
from workbench.run_state import PATIENCE_S
from workbench.runs import LAUNCHER_LOCK, Run, RunsFolderError, RunStore
from workbench.stack_options import StackOptions

if TYPE_CHECKING:
    from agents.config import TrainingConfig

ENTRY = ("-m", "workbench.stacked_training")
"""What Python runs as the process of a stack."""


def launch_stacked(store: RunStore, configs: Sequence[TrainingConfig], options: StackOptions) -> list[Run]:
    """New runs with these configurations, all started now in one process that outlives us.

    They never wait in the queue: the launcher's lock is held until the process has their locks, so that nobody else
    starts one of them by itself.

    Raises:
        UsageError: SAC or PPO is asked for.
        RunsFolderError: the runs folder cannot be written.
    """
    _refuse_library(configs)
    locks: list[int] = []
    try:
        store.root.mkdir(parents=True, exist_ok=True)
        with waiting_lock(store.root / LAUNCHER_LOCK):
            runs = [store.create(config) for config in configs]
            for run in runs:
                lock = run.claim()
                assert lock is not None, "a run nobody knows of is held"
                locks.append(lock)
                alive = {"state": "running", "started": now(), "updated": now(), "beat_s": time.monotonic()}
                run.write_state(dataclasses.replace(run.state, **alive, patience_s=PATIENCE_S))
            folders = [str(run.path) for run in runs]
            places = ["--device", options.device, "--simulator", options.simulator]
            held = ["--locks", ",".join(map(str, locks))]
            spawn((*ENTRY, *places, *held, *folders), locks, runs[0].path / "log.txt")
    except OSError as error:
        raise RunsFolderError(f"runs folder {store.root} cannot be written: {error.strerror}") from error
    finally:
        for lock in locks:
            os.close(lock)
    return runs


def _refuse_library(configs: Sequence[TrainingConfig]) -> None:
    from agents.config import VARIANTS

    for config in configs:
        if VARIANTS[config.variant].from_library:
            raise UsageError(f"variant '{config.variant}' cannot be stacked; train it without --stacked and --device")
