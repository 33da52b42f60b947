"""The one way to the disk of everything that must survive a crash: whole files replaced, lines appended.

Every step that can fail or be cut short by a crash is a method of `Disk`; tests put another in its place and let each
step fail in turn.
"""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

TEMPORARY = ".tmp"
"""Ending of files that are not whole yet; who finds one after a crash may remove it."""


class Disk:
    """The steps that writing consists of."""

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        """Write all of it."""
        left = memoryview(data)
        while left:
            left = left[os.write(descriptor, left) :]

    def sync(self, descriptor: int) -> None:
        """Wait until a file or a folder is on the disk itself."""
        os.fsync(descriptor)

    def replace(self, old: Path, new: Path) -> None:
        """Give a file the name of another, which is gone then."""
        os.replace(old, new)

    def cut(self, descriptor: int, size: int) -> None:
        """Shorten a file [bytes]."""
        os.ftruncate(descriptor, size)

    def remove(self, path: Path) -> None:
        """Remove a file, if it is there."""
        path.unlink(missing_ok=True)


disk = Disk()
"""What everything below writes with."""


def replace_file(path: Path, data: bytes) -> None:
    """Put `data` at `path` in one step: whatever crashes, readers find the old content or the new, never half.

    Raises:
        OSError: it could not be done; the old content is still there.
    """
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}{TEMPORARY}")
    try:
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        try:
            disk.write(descriptor, data)
            disk.sync(descriptor)
        finally:
            os.close(descriptor)
        disk.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            disk.remove(temporary)
        raise
    sync_folder(path.parent)


def append(path: Path, data: bytes) -> None:
    """Add `data` at the end of a file; it is on the disk when this returns.

    Raises:
        OSError: it could not be done; the file is as long as before, as far as the disk allows even that.
    """
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    try:
        size = os.fstat(descriptor).st_size
        try:
            disk.write(descriptor, data)
            disk.sync(descriptor)
        except BaseException:
            # Half a line would swallow the next one.
            with contextlib.suppress(OSError):
                disk.cut(descriptor, size)
            raise
    finally:
        os.close(descriptor)


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk itself."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        disk.sync(descriptor)
    finally:
        os.close(descriptor)


def sweep(folder: Path) -> None:
    """Remove what a crash left half written in a folder; only who alone writes there may call this."""
    for path in folder.glob(f".*{TEMPORARY}"):
        with contextlib.suppress(OSError):
            disk.remove(path)
