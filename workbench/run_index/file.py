"""The index of the runs as a SQLite file: a cache, thrown away and made anew whenever anything about it is wrong."""

from __future__ import annotations

import contextlib
import dataclasses
import sqlite3
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

from workbench.run_index.query import RunSearch, order, where
from workbench.run_index.record import RunRecord

NAME = ".index.sqlite"
BUSY_S = 5.0
MEMORY = ":memory:"
BATCH: Final = 200

FIELDS: Final = tuple(field.name for field in dataclasses.fields(RunRecord))
COLUMNS: Final = (*FIELDS, "haystack", "folder_stamp", "file_stamps", "checksum")
SCHEMA: Final = (
    f"CREATE TABLE run ({', '.join(COLUMNS)}, PRIMARY KEY (folder)) WITHOUT ROWID; "
    "CREATE INDEX run_trashed ON run (trashed)"
)
VERSION: Final = zlib.crc32(SCHEMA.encode()) >> 1
"""Another table is another version: nobody has to remember to count."""
_PUT: Final = f"INSERT OR REPLACE INTO run VALUES ({', '.join('?' * len(COLUMNS))})"
_SELECT: Final = f"SELECT {', '.join(FIELDS)} FROM run"

Stamps = tuple[str, str]
"""What the folder and its files looked like when a record was read."""


class IndexDamaged(Exception):
    """The file is no index, or not one that can be trusted."""


class IndexFile:
    """One open index file. Its methods raise `sqlite3.Error` when the file lets them down."""

    def __init__(self, path: Path | None) -> None:
        """Open the index at `path`, made where there is none; None keeps it in memory.

        Raises:
            IndexDamaged: it is no SQLite file, of another version, or its content contradicts itself.
            sqlite3.OperationalError: the file cannot be read, written or waited for.
        """
        self._path = path
        name = MEMORY if path is None else str(path)
        self._database = sqlite3.connect(name, timeout=BUSY_S, check_same_thread=False, isolation_level=None)
        try:
            self._prepare()
            self.inode = None if path is None else path.stat().st_ino
        except (sqlite3.OperationalError, OSError) as error:
            self.close()
            raise sqlite3.OperationalError(str(error)) from error
        except (sqlite3.DatabaseError, IndexDamaged) as error:
            self.close()
            raise IndexDamaged(str(error)) from error

    def _prepare(self) -> None:
        self._database.execute(f"PRAGMA busy_timeout={int(1000 * BUSY_S)}")
        if self._database.execute("SELECT count(*) FROM sqlite_master").fetchone() != (0,):
            self._verify()
        # Where WAL cannot be had (some network folders) SQLite keeps its old journal, and so do we.
        self._database.execute("PRAGMA journal_mode=WAL").fetchone()
        self._database.execute("PRAGMA synchronous=NORMAL")
        if self._version() == 0:
            self._database.executescript(f"BEGIN IMMEDIATE; {SCHEMA}; PRAGMA user_version={VERSION}; COMMIT")

    def _verify(self) -> None:
        if self._version() != VERSION:
            raise IndexDamaged("it is of another version")
        if self._database.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
            raise IndexDamaged("its pages are damaged")
        for row in self._database.execute(f"SELECT {', '.join(COLUMNS)} FROM run"):
            if row[-1] != _checksum(row[:-1]):
                raise IndexDamaged("a row of it is damaged")

    def _version(self) -> int:
        return int(self._database.execute("PRAGMA user_version").fetchone()[0])

    def close(self) -> None:
        """Let go of the file."""
        with contextlib.suppress(sqlite3.Error):
            self._database.close()

    def is_current(self) -> bool:
        """Whether the file that is open is still the one at its path."""
        if self._path is None:
            return True
        try:
            return self._path.stat().st_ino == self.inode
        except OSError:
            return False

    def stamps(self) -> dict[str, Stamps]:
        """What each folder looked like when it was read."""
        rows = self._database.execute("SELECT folder, folder_stamp, file_stamps FROM run")
        return {folder: (stamp, files) for folder, stamp, files in rows}

    def write(self, records: Sequence[tuple[RunRecord, Stamps]], gone: Iterable[str] = ()) -> None:
        """Put these records in and take those of folders that are gone out, in one transaction."""
        rows = [_row(record, stamps) for record, stamps in records]
        self._database.execute("BEGIN IMMEDIATE")
        try:
            self._database.executemany("DELETE FROM run WHERE folder = ?", [(folder,) for folder in gone])
            self._database.executemany(_PUT, rows)
            self._database.execute("COMMIT")
        except BaseException:
            with contextlib.suppress(sqlite3.Error):
                self._database.execute("ROLLBACK")
            raise

    def find(self, search: RunSearch, first: int = 0, most: int = -1) -> list[RunRecord]:
        """The records that are wanted, in order: at most `most` (all, if negative) from number `first` on."""
        condition, values = where(search)
        # The order is one of our own words, never the person's.
        sql = f"{_SELECT} WHERE {condition} ORDER BY {order(search.sort)} LIMIT ? OFFSET ?"
        return [RunRecord(*row) for row in self._database.execute(sql, [*values, most, max(first, 0)])]

    def count(self, search: RunSearch) -> int:
        """How many records are wanted."""
        condition, values = where(search)
        return int(self._database.execute(f"SELECT count(*) FROM run WHERE {condition}", values).fetchone()[0])

    def running(self) -> list[RunRecord]:
        """The records whose file says "running"."""
        return [RunRecord(*row) for row in self._database.execute(f"{_SELECT} WHERE running = 1")]

    def counts(self, column: str, trashed: bool) -> dict[str, int]:
        """How many runs have each value of a column; for `tags`, of each whole list of tags."""
        if column not in FIELDS:
            raise ValueError(f"the index has no column {column!r}")
        rows = self._database.execute(
            f"SELECT {column}, count(*) FROM run WHERE trashed = ? GROUP BY {column}", [int(trashed)]
        )
        return {str(value): int(count) for value, count in rows}


def _row(record: RunRecord, stamps: Stamps) -> tuple[Any, ...]:
    # Lone surrogates (from file names or damaged JSON) are no text for SQLite.
    values = (*(getattr(record, name) for name in FIELDS), record.haystack, *stamps)
    clean = tuple(
        value.encode("utf-8", "replace").decode("utf-8") if isinstance(value, str) else value for value in values
    )
    return (*clean, _checksum(clean))


def _checksum(values: Sequence[Any]) -> int:
    return zlib.crc32(repr(tuple(values)).encode())


def remove(path: Path) -> None:
    """Throw the index away, and what SQLite keeps beside it."""
    for suffix in ("", "-wal", "-shm", "-journal"):
        with contextlib.suppress(FileNotFoundError):
            path.with_name(path.name + suffix).unlink()
