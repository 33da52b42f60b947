"""The head's side of a cluster's runs: says what a node may begin, and takes in what it streams back.

It lives where the runs folder is. Whoever calls names the run and the attempt; an attempt that was given up (its node
was thought dead) is refused, so that no two ever write into one folder. All that travels is plain: names, numbers,
bytes.
"""

from __future__ import annotations

import dataclasses
import os
import re
import time
from pathlib import Path
from typing import Any, Final

from agents.disk import TEMPORARY, append, disk, sweep, sync_folder
from sim.errors import SubMasError
from workbench.checkpoint_manifest import MANIFEST_NAME, PART_NAME
from workbench.cluster.run_mirror import LINES, WHOLE
from workbench.run_files import waiting_lock
from workbench.run_folder import LAUNCHER_LOCK, Run, now
from workbench.run_state import RunState
from workbench.runs import RunStore

POLICY_NAME: Final = re.compile(r"policies/[a-z0-9][a-z0-9-]{0,80}\.(safetensors|json)")
CHECKPOINTS: Final = "checkpoints/"


class GivenUpError(SubMasError):
    """This attempt at a run counts no more: another has begun, or the run has ended."""


class ForeignNameError(SubMasError):
    """A node names a file that no training writes."""


class RunReceiver:
    """Takes in the runs of one engine."""

    def __init__(self, root: str) -> None:
        self._store = RunStore(root)
        self._attempts: dict[str, int] = {}

    def expect(self, run_id: str, attempt: int) -> None:
        """From now on this attempt at the run counts, and no other; 0 is none."""
        self._attempts[run_id] = attempt

    def begin(self, run_id: str, attempt: int, node: str) -> bool:
        """Whether a node may begin; the run is running then. False if somebody has stopped it while it waited."""
        run = self._run(run_id, attempt)
        with waiting_lock(self._store.root / LAUNCHER_LOCK):
            if run.state.state != "queued":
                return False
            state = dataclasses.replace(run.state, state="running", node=node[:200], updated=now(), error="")
            run.write_state(dataclasses.replace(state, started=state.started or now(), beat_s=None))
        return True

    def wishes(self, run_id: str, attempt: int) -> tuple[bool, bool, bool]:
        """Whether the run is to stop, to pause, to end at once."""
        run = self._run(run_id, attempt)
        return run.stop_requested(), run.pause_requested(), run.end_requested()

    def files(self, run_id: str, attempt: int) -> dict[str, int]:
        """Files that a node needs to begin or to go on, and their sizes [bytes]."""
        run = self._run(run_id, attempt)
        for folder in ("", "policies", "checkpoints"):
            sweep(run.path / folder)
        names = ["config.json", "state.json", *LINES, *WHOLE]
        for folder in ("policies", "checkpoints"):
            names += [f"{folder}/{path.name}" for path in sorted((run.path / folder).glob("*"))]
        return {name: size for name in names if (size := _size(run.path / name)) >= 0}

    def read(self, run_id: str, attempt: int, name: str, offset: int, size: int) -> bytes:
        """A piece of a file."""
        run = self._run(run_id, attempt)
        with (run.path / _checked(name, ("config.json", "state.json"))).open("rb") as file:
            file.seek(offset)
            return file.read(size)

    def append(self, run_id: str, attempt: int, name: str, offset: int, data: bytes) -> bool:
        """Add to a file that is `offset` bytes long; False if it is not, and has to be sent as a whole."""
        run = self._run(run_id, attempt)
        path = run.path / _checked(name)
        if max(_size(path), 0) != offset:
            return False
        append(path, data)
        return True

    def put(self, run_id: str, attempt: int, name: str, offset: int, data: bytes, last: bool) -> None:
        """A piece of a file; the last one puts the whole file in its place, in one step."""
        run = self._run(run_id, attempt)
        path = run.path / _checked(name)
        path.parent.mkdir(exist_ok=True)
        temporary = path.with_name(f".{path.name}.{attempt}{TEMPORARY}")
        flags = os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | (0 if offset else os.O_TRUNC)
        descriptor = os.open(temporary, flags, 0o644)
        try:
            os.lseek(descriptor, offset, os.SEEK_SET)
            disk.write(descriptor, data)
            if last:
                disk.sync(descriptor)
        finally:
            os.close(descriptor)
        if last:
            disk.replace(temporary, path)
            sync_folder(path.parent)

    def keep_checkpoints(self, run_id: str, attempt: int, names: list[str]) -> None:
        """Remove parts and manifests of checkpoints that are not among these, manifests first."""
        run = self._run(run_id, attempt)
        paths = sorted((run.path / CHECKPOINTS).glob("*"))
        for path in paths:  # "m" sorts before "replay" and "state"
            if _is_checkpoint(path.name) and f"{CHECKPOINTS}{path.name}" not in names:
                disk.remove(path)
        if paths and not names:
            (run.path / CHECKPOINTS).rmdir()

    def state(self, run_id: str, attempt: int, values: dict[str, Any]) -> None:
        """How the run stands, told by this machine's clock; what the head decides stays as it is."""
        run = self._run(run_id, attempt)
        mine = run.state
        kept = {"engine": mine.engine, "node": mine.node, "retries": mine.retries, "resumes": mine.resumes, "pid": None}
        told = dataclasses.replace(RunState.from_json(values), **kept, created=mine.created, started=mine.started)
        run.write_state(dataclasses.replace(told, beat_s=time.monotonic() if told.state == "running" else None))

    def _run(self, run_id: str, attempt: int) -> Run:
        if self._attempts.get(run_id) != attempt:
            raise GivenUpError(f"attempt {attempt} at run {run_id[:40]} counts no more")
        return self._store.get(run_id)


def _checked(name: str, more: tuple[str, ...] = ()) -> str:
    """The name, if a training writes such a file.

    Raises:
        ForeignNameError: it does not.
    """
    known = name in (*LINES, *WHOLE, *more) or POLICY_NAME.fullmatch(name)
    if known or (name.startswith(CHECKPOINTS) and _is_checkpoint(name.removeprefix(CHECKPOINTS))):
        return name
    raise ForeignNameError(f"{name[:60]!r} is no file of a training")


def _is_checkpoint(name: str) -> bool:
    return bool(PART_NAME.fullmatch(name) or MANIFEST_NAME.fullmatch(name))


def _size(path: Path) -> int:
    """Bytes of a file, -1 if there is none."""
    try:
        return path.lstat().st_size
    except OSError:
        return -1
