"""Starts training processes: one per run, at most as many as there are cores, the rest wait in the queue.

There is no daemon. Whoever calls `drain` (a launch, a training that ends, the server's tick) starts what may
start; a file lock
makes them take turns, so no run starts twice and the limit holds whatever happens at once.
"""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import SubMasError
from workbench.run_files import RunFileError, waiting_lock
from workbench.run_folder import now
from workbench.run_state import PATIENCE_S
from workbench.runs import LAUNCHER_LOCK, Run, RunBusyError, RunsFolderError, RunStore

if TYPE_CHECKING:
    from agents.config import TrainingConfig

INHERITED = (
    "PATH",
    "HOME",
    "USER",
    "LANG",
    "LC_ALL",
    "TMPDIR",
    "PYTHONPATH",
    "VIRTUAL_ENV",
    "LD_LIBRARY_PATH",
    "XDG_CACHE_HOME",
    "CUDA_VISIBLE_DEVICES",
    "WARP_CACHE_PATH",
    # What chooses the order in which a product is summed: results must not depend on which process computes them.
    "ATEN_CPU_CAPABILITY",
    "MKL_CBWR",
    "NPY_DISABLE_CPU_FEATURES",
    "ONEDNN_MAX_CPU_ISA",
    "OPENBLAS_CORETYPE",
    "OPENBLAS_L2_SIZE",
)
"""Environment variables a training process gets from the one that launches it; no others."""

ENTRY = ("-m", "workbench.training")
"""What Python runs as a training process."""

log = logging.getLogger(__name__)
_children: list[subprocess.Popen[bytes]] = []


def cpu_count() -> int:
    """Cores this process may use: the number of trainings that run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def launch(store: RunStore, config: TrainingConfig) -> Run:
    """A new run with this configuration, started now or when a core is free.

    Raises:
        RunsFolderError: the runs folder cannot be written.
    """
    run = store.create(config)
    drain(store)
    return run


def resume(store: RunStore, run: Run) -> Run:
    """Let a run go on from its last checkpoint, or from the start if it has none, now or when a core is free.

    However many ask at once, it is started once; the others are told so.

    Raises:
        RunBusyError: it is finished, waits already, or is alive.
        RunFileError: its folder is damaged or cannot be written.
    """
    if run.problem:
        raise RunFileError(f"run {run.id} cannot be resumed: {run.problem}")
    try:
        with waiting_lock(store.root / LAUNCHER_LOCK):
            run.requeue()
    except OSError as error:
        raise RunsFolderError(f"runs folder {store.root} cannot be written: {error.strerror}") from error
    drain(store)
    return run


def drain(store: RunStore, limit: int | None = None) -> list[Run]:
    """Start queued runs, oldest first, while fewer than `limit` (default: the number of cores) are alive.

    Returns the runs that were started.
    """
    _children[:] = [child for child in _children if child.poll() is None]
    if not any(run.state.state == "queued" for run in _good_runs(store)):
        return []
    limit = cpu_count() if limit is None else limit
    started = []
    try:
        with waiting_lock(store.root / LAUNCHER_LOCK):
            runs = _good_runs(store)
            states = {run.id: run.state for run in runs}
            free = limit - sum(states[run.id].active and states[run.id].state != "queued" for run in runs)
            queue = sorted(
                (run for run in runs if states[run.id].state == "queued"),
                key=lambda run: (states[run.id].created, run.id),
            )
            for run in queue:
                if len(started) < free and _start(run):
                    started.append(run)
    except OSError as error:
        raise RunsFolderError(f"runs folder {store.root} cannot be written: {error.strerror}") from error
    return started


async def tend(store: RunStore, every_s: float = 2.0) -> None:
    """Keep the queue moving, for ever: the server's part, should a training die without draining the queue itself."""
    while True:
        try:
            await asyncio.to_thread(drain, store)  # with thousands of runs it would hold up the pages
        except SubMasError as error:
            log.warning("%s", error)
        await asyncio.sleep(every_s)


def _good_runs(store: RunStore) -> list[Run]:
    """Those that work, or may, on this machine's cores; a cluster's belong to its engine."""
    return [run for run in store.list() if not run.problem and not run.state.engine]


def _start(run: Run) -> bool:
    """Claim a queued run and spawn its process, which inherits the claim: no moment is without a holder."""
    lock = run.claim()
    if lock is None:
        return False
    try:
        if run.state.state != "queued":
            return False
        alive = {"state": "running", "started": now(), "updated": now(), "beat_s": time.monotonic()}
        starting = dataclasses.replace(run.state, **alive, patience_s=PATIENCE_S, error="")
        run.write_state(starting)
        try:
            spawn((*ENTRY, str(run.path), "--lock", str(lock)), (lock,), run.path / "log.txt")
        except OSError as error:
            reason = f"cannot start a training process: {error.strerror}"
            run.write_state(dataclasses.replace(starting, state="failed", error=reason))
            return False
        return True
    except RunFileError:
        return False
    finally:
        os.close(lock)


def spawn(arguments: Sequence[str], locks: Sequence[int], log_file: Path) -> None:
    """Start a training process that inherits these locks and outlives us; what it prints goes to the end of a log.

    Raises:
        OSError: it cannot be started.
    """
    with log_file.open("ab") as log:
        child = subprocess.Popen(
            [sys.executable, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            pass_fds=tuple(locks),
            env=environment(),
            start_new_session=True,
        )
    _children.append(child)


def environment() -> dict[str, str]:
    """The environment of a training process: a fixed list of variables, and one thread per process."""
    kept = {name: os.environ[name] for name in INHERITED if name in os.environ}
    # `python -m workbench.training` has to find the packages also where they are not installed.
    source = str(Path(__file__).resolve().parents[1])
    kept["PYTHONPATH"] = os.pathsep.join(filter(None, [source, kept.get("PYTHONPATH")]))
    return kept | {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1"}


def stop_now(run: Run) -> None:
    """End a run at once, in the middle of an epoch; its best policy so far stays.

    A run that was asked to stop takes SIGTERM as the second ask (`workbench.training`). One that is stalled may hear
    no ask at all; it is killed and then counts as interrupted.
    """
    with contextlib.suppress(RunBusyError):
        run.request_stop()
    state = run.state
    if state.engine and run.is_alive():
        run.request_end()  # it may work on another machine
    elif state.pid and run.is_alive():
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.kill(state.pid, signal.SIGKILL if state.state == "stalled" else signal.SIGTERM)
