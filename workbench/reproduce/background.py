"""Reproductions as processes of their own, for pages: started, found again by any page, and stopped."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from workbench.launcher import environment
from workbench.reproduce.job import LOCKS, BusyError, Job, Kind, kind_of, read_job
from workbench.reproduce.protocol import Item
from workbench.reproduce.seed_counts import SeedCounts
from workbench.run_files import is_locked
from workbench.runs import RunsFolderError, RunStore

ENTRY: tuple[str, ...] = ("-m", "workbench")
"""What Python runs in front of `reproduce …`."""
LOG_BYTES: Final = 4000


@dataclass(frozen=True)
class Order:
    """What a page asks for."""

    item: Item
    profile: str
    seeds: SeedCounts
    episodes: int

    def arguments(self, root: Path, results: Path) -> list[str]:
        """Arguments of `workbench`."""
        return [
            "reproduce", self.item, "--profile", self.profile, *self.seeds.options.split(),
            "--episodes", str(self.episodes), "--runs", str(root), "--out", str(results),
        ]  # fmt: skip


_children: dict[tuple[Path, Kind], subprocess.Popen[bytes]] = {}
"""Processes this server started, until they have ended: they need a parent that waits for them."""


def start(root: Path, results: Path, order: Order) -> None:
    """Begin a reproduction that outlives the page and the server; its result sets go to `results`/PROFILE.

    Raises:
        BusyError: one of this kind works or begins already in this runs folder.
        RunsFolderError: the folder cannot be written.
    """
    kind = kind_of([order.item])
    if beginning(root, kind) or is_locked(root / LOCKS[kind]):
        raise BusyError("another reproduction works in this runs folder; wait for it or stop it")
    command = [sys.executable, *ENTRY, *order.arguments(root, results)]
    try:
        root.mkdir(parents=True, exist_ok=True)
        with log_path(root, kind).open("wb") as log:
            _children[root, kind] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, env=environment(),
                start_new_session=True,
            )  # fmt: skip
    except OSError as error:
        raise RunsFolderError(f"runs folder {root} cannot be written: {error.strerror}") from error


def log_path(root: Path, kind: Kind) -> Path:
    """What the latest background job of a kind printed."""
    return (root / LOCKS[kind]).with_suffix(".log")


def beginning(root: Path, kind: Kind) -> bool:
    """Whether a process that this server started lives but has not yet written its file."""
    child = _children.get((root, kind))
    if child is None or child.poll() is not None:
        return False
    job = read_job(root, kind)
    return job is None or job.pid != child.pid


def failure(root: Path, kind: Kind) -> str:
    """Why the process that this server started last ended before it began; empty if it did not."""
    child = _children.get((root, kind))
    if child is None or child.poll() in (None, 0):
        return ""
    job = read_job(root, kind)
    if job is not None and job.pid == child.pid:
        return ""
    with contextlib.suppress(OSError):
        lines = log_path(root, kind).read_bytes()[-LOG_BYTES:].decode(errors="replace").strip().splitlines()
        if lines:
            return lines[-1].removeprefix("workbench: ")
    return f"the process ended with exit code {child.poll()}"


def stop(store: RunStore, kind: Kind, trainings_too: bool = False) -> Job | None:
    """Ask a job to end as Ctrl-C does: nothing new is started, and what is done is kept.

    Args:
        store: the runs folder.
        kind: which of its jobs.
        trainings_too: whether the trainings that run for it are asked to stop as well.
    """
    job = read_job(store.root, kind)
    # Only while its lock is held is the number that of its process.
    if job is None or not job.alive:
        return None
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(job.pid, signal.SIGINT)
    for run_id in job.running if trainings_too else ():
        run = store.get(run_id)
        if run.state.active:
            run.request_stop()
    return job


def said(job: Job) -> Sequence[str]:
    """The last things a job said, newest first."""
    return tuple(reversed(job.lines))
