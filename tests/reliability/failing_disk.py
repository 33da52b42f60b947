"""Disks that die, fill up or refuse at a chosen step, in place of `agents.disk.disk`."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from agents import disk
from agents.disk import Disk


class Death(BaseException):
    """The process is gone: nothing that would tidy up after an error may run its disk steps any more."""


class CountingDisk(Disk):
    """Counts the steps; `before` may do something at each."""

    def __init__(self) -> None:
        self.steps = 0

    def before(self, step: str, path: Path) -> None:
        self.steps += 1

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        self.before("write", path_of(descriptor))
        super().write(descriptor, data)

    def sync(self, descriptor: int) -> None:
        self.before("sync", path_of(descriptor))
        super().sync(descriptor)

    def replace(self, old: Path, new: Path) -> None:
        self.before("replace", new)
        super().replace(old, new)

    def cut(self, descriptor: int, size: int) -> None:
        self.before("cut", path_of(descriptor))
        super().cut(descriptor, size)

    def remove(self, path: Path) -> None:
        self.before("remove", path)
        super().remove(path)


class KilledDisk(CountingDisk):
    """The process is killed at a step, a write when half of it is done; what was written before stays."""

    def __init__(self, at: int) -> None:
        super().__init__()
        self.at = at

    def before(self, step: str, path: Path) -> None:
        super().before(step, path)
        if self.steps >= self.at:
            self.die()

    def die(self) -> None:
        raise Death

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        if self.steps + 1 == self.at:
            Disk.write(self, descriptor, memoryview(data)[: len(data) // 2])
        super().write(descriptor, data)


class PowerCutDisk(KilledDisk):
    """The power fails at a step: contents and names that were never synced are as they were before."""

    def __init__(self, at: int) -> None:
        super().__init__(at)
        self.contents: dict[Path, bytes] = {}
        """Files written to since they were last synced, and what they held then."""
        self.names: list[tuple[Path, bytes | None]] = []
        """Names changed since their folder was synced, and what they stood for."""

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        self._remember(descriptor)
        super().write(descriptor, data)

    def cut(self, descriptor: int, size: int) -> None:
        self._remember(descriptor)
        super().cut(descriptor, size)

    def sync(self, descriptor: int) -> None:
        super().sync(descriptor)
        path = path_of(descriptor)
        self.contents.pop(path, None)
        self.names = [(name, content) for name, content in self.names if name.parent != path]

    def replace(self, old: Path, new: Path) -> None:
        before = new.read_bytes() if new.exists() else None
        super().replace(old, new)
        self.names.append((new, before))
        if old in self.contents:
            # The new name may reach the disk before what it stands for: the classic way to lose both.
            self.contents[new] = self.contents.pop(old)
            self.names.pop()

    def remove(self, path: Path) -> None:
        before = path.read_bytes() if path.exists() else None
        super().remove(path)
        self.names.append((path, before))

    def die(self) -> None:
        for path, content in self.contents.items():
            if path.exists():
                path.write_bytes(content)
        for name, content in reversed(self.lost_names()):
            if content is None:
                name.unlink(missing_ok=True)
            else:
                name.write_bytes(content)
        self.contents, self.names = {}, []
        super().die()

    def lost_names(self) -> list[tuple[Path, bytes | None]]:
        return self.names

    def _remember(self, descriptor: int) -> None:
        path = path_of(descriptor)
        self.contents.setdefault(path, path.read_bytes())


class ReorderingDisk(PowerCutDisk):
    """The power fails when of all names that were not synced only the newest has reached the disk."""

    def lost_names(self) -> list[tuple[Path, bytes | None]]:
        return self.names[:-1]


class RefusingDisk(CountingDisk):
    """One step fails with an error, the others work."""

    def __init__(self, at: int, code: int) -> None:
        super().__init__()
        self.at, self.code = at, code

    def before(self, step: str, path: Path) -> None:
        super().before(step, path)
        if self.steps == self.at:
            raise OSError(self.code, os.strerror(self.code))


class SmallDisk(Disk):
    """Holds so many bytes below a folder and no more; a write that does not fit is done as far as it does."""

    def __init__(self, folder: Path, capacity: int) -> None:
        self.folder, self.capacity = folder, capacity

    def write(self, descriptor: int, data: bytes | memoryview) -> None:
        used = sum(path.stat().st_size for path in self.folder.rglob("*") if path.is_file())
        free = max(self.capacity - used, 0)
        super().write(descriptor, memoryview(data)[:free])
        if free < len(data):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def path_of(descriptor: int) -> Path:
    return Path(os.readlink(f"/proc/self/fd/{descriptor}"))


@contextmanager
def installed(other: Disk) -> Iterator[Disk]:
    """Everything is written with this disk for a while."""
    before, disk.disk = disk.disk, other
    try:
        yield other
    finally:
        disk.disk = before
