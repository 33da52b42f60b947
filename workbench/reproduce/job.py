"""The reproduction under way, as a file in the runs folder: a page reads there how far it is, and whether it lives.

What trains and what only flies are two kinds of job: each is alone of its kind in a runs folder.
"""

from __future__ import annotations

import contextlib
import dataclasses
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from sim.errors import SubMasError
from workbench.reproduce.protocol import TRAINED_FOR, Item
from workbench.run_files import RunFileError, is_locked, read_json, take_lock, write_json
from workbench.run_folder import now
from workbench.runs import RunsFolderError

Kind = Literal["trainings", "flights"]
LOCKS: Final[Mapping[Kind, str]] = {"trainings": ".reproduce.lock", "flights": ".reproduce-flights.lock"}
EVERY_S: Final = 0.5
"""Time between two writings of the file."""
LINES_KEPT: Final = 30


class BusyError(SubMasError):
    """Two reproductions would train the same things twice."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """How a reproduction stands; the content of its file."""

    items: tuple[str, ...]
    profile: str
    command: str
    results: str
    """Folder of its result sets."""
    pid: int
    state: str = "running"
    """`running`, `finished`, `failed`, `interrupted`; `died` is never written but found out."""
    doing: str = "starting"
    """How far it is, in a few words."""
    share: float = 0.0
    """Share that is done, 0 to 1."""
    running: tuple[str, ...] = ()
    """Runs that train for it now."""
    lines: tuple[str, ...] = ()
    """The last things it said."""
    started: str = ""
    updated: str = ""

    @property
    def alive(self) -> bool:
        """Whether it works."""
        return self.state == "running"


def kind_of(items: Sequence[Item]) -> Kind:
    """Whether any of these items needs trainings."""
    return "trainings" if any(TRAINED_FOR[item] for item in items) else "flights"


def job_path(root: Path, kind: Kind) -> Path:
    """The file of a runs folder's latest job of one kind."""
    return (root / LOCKS[kind]).with_suffix(".json")


def read_job(root: Path, kind: Kind) -> Job | None:
    """The latest job of one kind, or None if there never was one (or its file is no such file)."""
    # Asked first: a job writes how it ended before it lets its lock go.
    alive = is_locked(root / LOCKS[kind])
    try:
        values: dict[str, Any] = read_json(job_path(root, kind))
        lists = {name: tuple(map(str, values[name])) for name in ("items", "running", "lines")}
        known: dict[str, Any] = values | lists | {"pid": int(values["pid"]), "share": float(values["share"])}
        job = Job(**known)
    except (RunFileError, KeyError, TypeError, ValueError):
        return None
    return dataclasses.replace(job, state="died") if job.alive and not alive else job


class JobFile:
    """Writes a job's file while it works; without a path it writes nothing."""

    def __init__(self, path: Path | None, job: Job) -> None:
        self._path, self._job, self._written_s = path, job, -EVERY_S

    def update(self, **values: Any) -> None:
        """Change what the file says, at most every half second."""
        self._job = dataclasses.replace(self._job, **values)
        if time.monotonic() - self._written_s >= EVERY_S:
            self._write()

    def say(self, line: str) -> None:
        """Add a line."""
        self.update(lines=(*self._job.lines, line)[-LINES_KEPT:])

    def end(self, state: str) -> None:
        """Write how it ended."""
        self._job = dataclasses.replace(self._job, state=state, running=())
        self._write()

    def _write(self) -> None:
        if self._path is not None:
            self._written_s = time.monotonic()
            self._job = dataclasses.replace(self._job, updated=now())
            write_json(self._path, dataclasses.asdict(self._job))


@contextlib.contextmanager
def working(root: Path, kind: Kind, job: Job) -> Iterator[JobFile]:
    """Keep a second job of this kind out of this runs folder, and tell how this one stands.

    What only flies needs no runs folder; where there is none, nothing is locked or written.

    Raises:
        BusyError: another one works here.
        RunsFolderError: the folder cannot be written.
    """
    if kind == "flights" and not root.is_dir():
        yield JobFile(None, job)
        return
    lock = _lock(root, kind)
    try:
        file = JobFile(job_path(root, kind), job)
        try:
            # Whoever reads the file may stop the job at once, so it is written where a stop is noted.
            file.update()
            yield file
        except BaseException as error:
            # Ctrl-C may come before whoever works here is ready for it.
            file.end("interrupted" if isinstance(error, KeyboardInterrupt) else "failed")
            raise
    finally:
        os.close(lock)


def _lock(root: Path, kind: Kind) -> int:
    try:
        root.mkdir(parents=True, exist_ok=True)
        lock = take_lock(root / LOCKS[kind])
    except OSError as error:
        raise RunsFolderError(f"runs folder {root} cannot be written: {error.strerror}") from error
    if lock is None:
        raise BusyError(f"another reproduction works in {root}; wait for it, or choose other runs with --runs")
    return lock
