"""The index of the runs: what makes thousands of them quick to list and search. The folders stay the truth.

Written by the process that serves the pages alone. `look` compares the folders with what the index knows and reads only
those that changed.
"""

from __future__ import annotations

import os
import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from workbench.run_files import RunFileError, is_locked
from workbench.run_folder import Run, is_run_id
from workbench.run_index.file import BATCH, NAME, IndexDamaged, IndexFile, Stamps, remove
from workbench.run_index.query import FACETS, RunSearch
from workbench.run_index.record import RunRecord, file_stamps, folder_stamp, read_record
from workbench.runs import TRASH, in_trash

THOROUGH_S = 15.0
"""Seconds between two looks at the files themselves; in between, their folders tell."""
T = TypeVar("T")
Found = dict[str, Path]


@dataclass
class _Seen:
    """What the folders looked like when they were read."""

    stamps: dict[str, Stamps] = field(default_factory=dict)
    thorough_at: float = float("-inf")


class RunIndex:
    """The records of all runs of one folder, shared by all pages of the server. Safe to use from several threads."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.version = 0
        """Counts up whenever any record has changed."""
        self.notice = ""
        """A sentence for the person, where the index had to be made anew or cannot be kept; empty otherwise."""
        self.reading: tuple[int, int] | None = None
        """Folders read and to read, while there are many."""
        self._file: IndexFile | None = None
        self._seen = _Seen()
        self._using = threading.RLock()
        self._looking = threading.Lock()

    # What pages ask. Answered from the index as it stands; `look` brings it up to date.

    def find(self, search: RunSearch | None = None, first: int = 0, most: int = -1) -> list[RunRecord]:
        """The runs that are wanted, in order: at most `most` (all, if negative) from number `first` on."""
        return self._ask(lambda file: file.find(search or RunSearch(), first, most))

    def count(self, search: RunSearch | None = None) -> int:
        """How many runs are wanted."""
        return self._ask(lambda file: file.count(search or RunSearch()))

    @property
    def is_open(self) -> bool:
        """Whether it answers at once."""
        return self._file is not None

    def get(self, run_id: str) -> RunRecord | None:
        """The run of this id, a living one rather than one in the trash; None when there is none."""
        same = [record for trashed in (False, True) for record in self.find(RunSearch(text=run_id, trashed=trashed))]
        return next((record for record in same if record.id == run_id), None)

    def facets(self, trashed: bool = False) -> dict[str, dict[str, int]]:
        """Of each facet, its values and how many runs have them."""
        columns = {name: "tags" if name == "tag" else name for name in FACETS}
        counts = {name: self._ask(lambda file, c=column: file.counts(c, trashed)) for name, column in columns.items()}
        tags: dict[str, int] = {}
        for together, count in counts["tag"].items():
            for tag in filter(None, together.split("\n")):
                tags[tag] = tags.get(tag, 0) + count
        named = {name: {value: n for value, n in found.items() if value} for name, found in counts.items()}
        return {**named, "tag": tags}

    # How it follows the folders.

    def look(self, thorough: bool = False) -> bool:
        """Bring the index up to date with the folders; whether anything has changed.

        Args:
            thorough: look at the files too, as happens by itself every quarter of a minute.
        """
        with self._looking:
            self._reopen_if_replaced()
            self._ask(lambda file: None)  # opened, so that it is known what was seen
            now = time.monotonic()
            thorough = thorough or now - self._seen.thorough_at > THOROUGH_S
            if thorough:
                self._seen.thorough_at = now
            found = dict(_folders(self.root))
            gone = [folder for folder in self._seen.stamps if folder not in found]
            changed = self._changed(found, thorough)
            if gone or changed:
                self._take(found, changed, gone)
                self.version += 1
            return bool(gone or changed)

    def _changed(self, found: Found, thorough: bool) -> dict[str, Stamps]:
        """The folders to read again, and what they look like now."""
        changed: dict[str, Stamps] = {}
        for folder, path in found.items():
            before, name = self._seen.stamps.get(folder), str(path)
            stamp = folder_stamp(name)
            if before is None or before[0] != stamp:
                changed[folder] = (stamp, file_stamps(name))
            elif thorough and (files := file_stamps(name)) != before[1]:
                changed[folder] = (stamp, files)
        for record in self._ask(lambda file: file.running()):
            if record.folder in found and record.folder not in changed and self._died_or_rose(record):
                changed[record.folder] = self._seen.stamps[record.folder]
        return changed

    def _died_or_rose(self, record: RunRecord) -> bool:
        """Whether a run that was alive is dead, silent for too long, or the other way round; no file says so."""
        try:
            return Run(self.root / record.folder).state.state != record.state
        except RunFileError:
            return is_locked(self.root / record.folder / "run.lock") != (record.state == "running")

    def _take(self, found: Found, changed: dict[str, Stamps], gone: list[str]) -> None:
        folders = list(changed)
        for start in range(0, max(len(folders), 1), BATCH):
            batch = folders[start : start + BATCH]
            if len(folders) > BATCH:
                self.reading = (start, len(folders))
            records = [(read_record(found[each], each, in_trash(each)), changed[each]) for each in batch]
            removed = gone if start == 0 else []
            self._ask(lambda file, r=records, g=removed: file.write(r, g))
            self._seen.stamps.update({each: changed[each] for each in batch})
            self.version += 1
        for folder in gone:
            self._seen.stamps.pop(folder, None)
        self.reading = None

    # The file, and what is done when it fails.

    def _reopen_if_replaced(self) -> None:
        with self._using:
            file = self._file
            appeared = file is not None and file.inode is None and not self.notice and self.root.is_dir()
            if file is not None and (appeared or not file.is_current()):
                self._drop()

    def _ask(self, question: Callable[[IndexFile], T]) -> T:
        """The answer of the file; of a new one, filled from the folders at the next look, where this one fails."""
        with self._using:
            try:
                return question(self._opened())
            except sqlite3.OperationalError as error:
                if "locked" in str(error) or "busy" in str(error):
                    raise
                self._keep_in_memory(str(error))
            except sqlite3.DatabaseError as error:
                self._rebuild(str(error))
            return question(self._opened())

    def _opened(self) -> IndexFile:
        if self._file is None:
            self._file = self._open()
            self._seen = _Seen(self._file.stamps())
        return self._file

    def _open(self) -> IndexFile:
        path = self.root / NAME
        if not self.root.is_dir():
            return IndexFile(None)
        try:
            return IndexFile(path)
        except IndexDamaged as error:
            self._rebuild(str(error))
        except sqlite3.OperationalError as error:
            self._keep_in_memory(str(error))
        return self._opened()

    def _rebuild(self, reason: str) -> None:
        self._drop()
        self.notice = f"The index of the runs was not usable ({reason}) and is rebuilt from the run folders."
        try:
            remove(self.root / NAME)
        except OSError as error:
            self._keep_in_memory(str(error.strerror))

    def _keep_in_memory(self, reason: str) -> None:
        self._drop()
        self.notice = f"The index of the runs cannot be kept on disk ({reason}); it is made anew at every start."
        self._file = IndexFile(None)

    def _drop(self) -> None:
        if self._file is not None:
            self._file.close()
        self._file, self._seen = None, _Seen()

    def close(self) -> None:
        """Let go of the file."""
        with self._using:
            self._drop()


def _folders(root: Path) -> Iterator[tuple[str, Path]]:
    """Every run folder below `root` by its path there, those in the trash included."""
    yield from ((path.name, path) for path in _entries(root) if is_run_id(path.name))
    trash = root / TRASH
    yield from ((f"{TRASH}/{path.name}", path) for path in _entries(trash) if is_run_id(path.name.partition(".")[0]))


def _entries(folder: Path) -> list[Path]:
    try:
        return [folder / name for name in os.listdir(folder)]
    except OSError:
        return []
