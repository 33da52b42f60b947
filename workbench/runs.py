"""The runs folder: one folder per training, which is the truth about it, and the trash, from which runs come back."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import string
import time
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import SubMasError, UsageError, shorten
from workbench.run_files import RunFileError, waiting_lock, write_json
from workbench.run_folder import LAUNCHER_LOCK, Run, RunBusyError, is_run_id, now, problem_of
from workbench.run_state import RunState

if TYPE_CHECKING:
    from agents.config import TrainingConfig

__all__ = [
    "LAUNCHER_LOCK", "Run", "RunBusyError", "RunStore", "RunsFolderError", "UnknownRunError", "in_trash", "is_run_id",
]  # fmt: skip

TRASH = ".trash"
_LEAVING = ".leaving-"
_SUFFIX_ALPHABET = string.ascii_lowercase + string.digits


class UnknownRunError(UsageError):
    """No run of this id in the runs folder, or not an id at all."""


class RunsFolderError(SubMasError):
    """The runs folder cannot be made, read or written."""


def _new_id() -> str:
    suffix = "".join(secrets.choice(_SUFFIX_ALPHABET) for _ in range(6))
    return f"{datetime.now():%Y%m%d-%H%M%S}-{suffix}"


class RunStore:
    """All runs of one folder."""

    def __init__(self, root: Path | str) -> None:
        self.root = Path(root).expanduser().absolute()
        self._known: dict[str, Run] = {}

    def list(self) -> list[Run]:
        """Every run, newest first; a damaged one is among them and says what is wrong in `problem`."""
        runs = []
        for entry in self._scan():
            run = self._known.setdefault(entry.name, Run(Path(entry.path)))
            run.problem = problem_of(run)
            runs.append(run)
        self._known = {run.id: run for run in runs}
        return sorted(runs, key=lambda run: run.id, reverse=True)

    def _scan(self) -> Iterator[os.DirEntry[str]]:
        try:
            with os.scandir(self.root) as entries:
                yield from [entry for entry in entries if is_run_id(entry.name)]
        except FileNotFoundError:
            return
        except OSError as error:
            raise RunsFolderError(f"runs folder {self.root} cannot be read: {error.strerror}") from error

    def get(self, run_id: str) -> Run:
        """The run of this id.

        Raises:
            UnknownRunError: not an id, or no such run.
        """
        if not is_run_id(run_id):
            raise UnknownRunError(f"{shorten(run_id)!r} is not a run id; 'workbench runs' lists them")
        path = self.root / run_id
        if not os.path.lexists(path):
            raise UnknownRunError(f"run {run_id} is not in {self.root}; 'workbench runs' lists those that are")
        run = self._known.setdefault(run_id, Run(path))
        run.problem = problem_of(run)
        return run

    def create(self, config: TrainingConfig, engine: str = "") -> Run:
        """A new run folder with this configuration, queued at an engine. It appears whole or not at all.

        Raises:
            RunsFolderError: the runs folder cannot be made or written.
        """
        run_id = _new_id()
        draft = self.root / f".new-{run_id}"
        try:
            (draft / "policies").mkdir(parents=True)
            (draft / "evaluations").mkdir()
            write_json(draft / "config.json", config.to_json())
            write_json(draft / "state.json", RunState("queued", created=now(), updated=now(), engine=engine).to_json())
            os.rename(draft, self.root / run_id)
        except (OSError, RunFileError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise RunsFolderError(
                f"runs folder {self.root} cannot be written ({reason}); choose another with --runs"
            ) from error
        return self.get(run_id)

    def delete(self, run_id: str) -> Path:
        """Move a run to the trash folder inside the runs folder, and say where it is now.

        Raises:
            RunBusyError: the run is alive.
        """
        run = self.get(run_id)
        target = self.root / TRASH / run_id
        try:
            (self.root / TRASH).mkdir(exist_ok=True)
            with waiting_lock(self.root / LAUNCHER_LOCK):
                _refuse_while_alive(run)
                if os.path.lexists(target):
                    target = target.with_name(f"{run_id}.{time.time_ns()}")
                os.rename(run.path, target)
        except OSError as error:
            raise RunsFolderError(f"run {run_id} cannot be deleted: {error.strerror}") from error
        self._known.pop(run_id, None)
        return target

    def trashed(self) -> list[Run]:
        """Every run in the trash, newest first; of one that was deleted twice both."""
        runs = [Run(path) for path in self._in_trash() if _trashed_id(path)]
        for run in runs:
            run.problem = problem_of(run)
        return sorted(runs, key=lambda run: run.path.name, reverse=True)

    def restore(self, run_id: str) -> Run:
        """Bring a run back from the trash, the one deleted last where there are several of its id.

        Raises:
            UnknownRunError: not an id, or no such run in the trash.
            RunBusyError: a run of this id is there already.
        """
        if not is_run_id(run_id):
            raise UnknownRunError(f"{shorten(run_id)!r} is not a run id; 'workbench runs trash' lists them")
        copies = [path for path in self._in_trash() if _trashed_id(path) == run_id]
        if not copies:
            raise UnknownRunError(f"run {run_id} is not in the trash; 'workbench runs trash' lists those that are")
        target = self.root / run_id
        try:
            with waiting_lock(self.root / LAUNCHER_LOCK):
                if os.path.lexists(target):
                    raise RunBusyError(f"run {run_id} cannot be restored: a run of this id is in {self.root}")
                os.rename(max(copies, key=_deleted_at), target)
        except OSError as error:
            raise RunsFolderError(f"run {run_id} cannot be restored: {error.strerror}") from error
        return self.get(run_id)

    def empty_trash(self) -> int:
        """Remove every run in the trash for good, and say how many. Nothing else ever removes one.

        Raises:
            RunsFolderError: one cannot be removed; those before it are gone.
        """
        removed = 0
        for path in self._in_trash():
            if not _trashed_id(path) and not path.name.startswith(_LEAVING):
                continue
            leaving = path.with_name(f"{_LEAVING}{path.name.removeprefix(_LEAVING)}")
            try:
                # Renamed first: a run that is half removed is never taken for one that can be restored.
                os.rename(path, leaving)
                leaving.unlink() if leaving.is_symlink() or leaving.is_file() else shutil.rmtree(leaving)
            except OSError as error:
                raise RunsFolderError(f"{path} cannot be removed: {error.strerror}") from error
            removed += 1
        return removed

    def _in_trash(self) -> list[Path]:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            return sorted((self.root / TRASH).iterdir())
        return []


def in_trash(folder: str) -> bool:
    """Whether a path below the runs folder is in the trash."""
    return folder.startswith(f"{TRASH}/")


def _trashed_id(path: Path) -> str:
    """The id of a run in the trash, where a later deletion of the same id has a time behind it; empty for others."""
    run_id, _, later = path.name.partition(".")
    return run_id if is_run_id(run_id) and (not later or later.isdigit()) else ""


def _deleted_at(path: Path) -> int:
    return int(path.name.partition(".")[2] or 0)


def _refuse_while_alive(run: Run) -> None:
    if run.path.is_symlink() or not run.path.is_dir():
        return
    # Patient: a training that has just written its last state needs a moment to leave.
    lock = run.claim()
    if lock is None:
        raise RunBusyError(f"run {run.id} is running; stop it before deleting it")
    os.close(lock)
