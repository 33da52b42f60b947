"""The bytes of a run folder: atomic JSON, append-only lines, and the lock that says a run is alive.

Only this module, `run_folder.py` and `runs.py` (which name the files) touch run folders, besides `agents/checkpoint.py`
for policies.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import io
import json
import math
import os
import stat
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from agents.disk import append, replace_file
from sim.errors import SubMasError

JSON_LIMIT_BYTES = 256 * 1024
LINE_LIMIT_BYTES = 64 * 1024
READ_LIMIT_BYTES = 8 * 1024 * 1024
PROBE_PATIENCE_S = 0.5

Signature = tuple[int, int, int]
ABSENT: Signature = (0, 0, 0)


class RunFileError(SubMasError):
    """A file of a run folder that cannot be read or written; the message names the file and the reason."""


def signature(path: Path) -> Signature:
    """(mtime in ns, size in bytes, inode), or ABSENT: differs once the file is replaced or appended to."""
    try:
        stat = path.stat()
    except OSError:
        return ABSENT
    return (stat.st_mtime_ns, stat.st_size, stat.st_ino)


def strict(value: Any) -> Any:
    """The same value with every non-finite number as None: run files hold strict JSON, never ``NaN``."""
    if isinstance(value, Mapping):
        return {str(key): strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [strict(item) for item in value]
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is not a JSON number")


def open_plain(path: Path, *, follow: bool = False) -> io.BufferedReader:
    """A file opened for reading.

    Raises:
        OSError: it is missing, or something else in its place: a pipe would make the reader wait for ever.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | (0 if follow else os.O_NOFOLLOW))
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode):
        return os.fdopen(descriptor, "rb")
    os.close(descriptor)
    code = errno.EISDIR if stat.S_ISDIR(mode) else errno.EINVAL
    raise OSError(code, os.strerror(code) if code == errno.EISDIR else "Not a plain file")


def read_json(path: Path, *, follow: bool = True) -> dict[str, Any]:
    """The JSON object in `path`; RunFileError when it is missing, too large, or anything else."""
    try:
        with open_plain(path, follow=follow) as file:
            data = file.read(JSON_LIMIT_BYTES + 1)
    except OSError as error:
        raise RunFileError(f"{path.name} cannot be read: {error.strerror}") from error
    if len(data) > JSON_LIMIT_BYTES:
        raise RunFileError(f"{path.name} is larger than {JSON_LIMIT_BYTES // 1024} kB")
    try:
        value = json.loads(data, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise RunFileError(f"{path.name} is not JSON: {error}") from error
    if not isinstance(value, dict):
        raise RunFileError(f"{path.name} holds a {type(value).__name__}, not an object")
    return value


def write_bytes(path: Path, data: bytes) -> None:
    """Replace `path` as a whole: whatever crashes, readers see the old content or the new."""
    try:
        replace_file(path, data)
    except OSError as error:
        raise RunFileError(f"cannot save {path}: {error.strerror}") from error


def write_json(path: Path, value: Mapping[str, Any]) -> None:
    """Replace `path` with a JSON object, atomically."""
    write_bytes(path, (json.dumps(strict(value), indent=2, allow_nan=False) + "\n").encode())


def append_line(path: Path, value: Mapping[str, Any]) -> None:
    """Append one JSON object as one line; it is on disk when this returns."""
    line = json.dumps(strict(value), allow_nan=False, separators=(",", ":")) + "\n"
    try:
        append(path, line.encode())
    except OSError as error:
        raise RunFileError(f"cannot save {path}: {error.strerror}") from error


def cut_back(path: Path, size: int) -> None:
    """Forget what was appended to a file since it was `size` bytes long; readers notice that it is another file.

    Raises:
        RunFileError: it is shorter than that, or cannot be read or written.
    """
    try:
        data = path.read_bytes() if path.exists() else b""
    except OSError as error:
        raise RunFileError(f"{path.name} cannot be read: {error.strerror}") from error
    if len(data) < size:
        raise RunFileError(f"{path.name} is {len(data)} bytes long and was {size} at the last checkpoint")
    if len(data) > size:
        write_bytes(path, data[:size])


class LineReader:
    """Reads a growing file of JSON lines piece by piece.

    A torn last line is "not yet" and is read once it is complete; a torn line before it is a RunFileError.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows = 0
        self.anew = False
        """The last call began at the start again, for the file had been cut back: what was read before is void."""
        self._offset = 0
        self._inode = 0

    def read_new(self) -> list[dict[str, Any]]:
        """All complete rows since the last call; all there are when `anew`."""
        self.anew = False
        rows: list[dict[str, Any]] = []
        while chunk := self._read_chunk(rows):
            complete = chunk.rfind(b"\n") + 1
            if not complete:
                break
            rows.extend(self._parse(line) for line in chunk[:complete].splitlines())
            self._offset += complete
        return rows

    def _read_chunk(self, rows: list[dict[str, Any]]) -> bytes:
        try:
            with open_plain(self.path, follow=True) as file:
                self._recognise(os.fstat(file.fileno()).st_ino, rows)
                file.seek(self._offset)
                chunk = file.read(READ_LIMIT_BYTES)
        except FileNotFoundError:
            return b""
        except OSError as error:
            raise RunFileError(f"{self.path.name} cannot be read: {error.strerror}") from error
        if b"\n" not in chunk and len(chunk) > LINE_LIMIT_BYTES:
            raise RunFileError(f"{self.path.name}, line {self.rows + 1} is longer than {LINE_LIMIT_BYTES // 1024} kB")
        return chunk

    def _recognise(self, inode: int, rows: list[dict[str, Any]]) -> None:
        """Begin again if this is another file than last time."""
        if self._inode not in (0, inode):
            self.anew, self.rows, self._offset = True, 0, 0
            rows.clear()
        self._inode = inode

    def _parse(self, line: bytes) -> dict[str, Any]:
        self.rows += 1
        try:
            value = json.loads(line, parse_constant=_no_constant)
        except (ValueError, RecursionError) as error:
            raise RunFileError(f"{self.path.name}, line {self.rows} is not JSON: {error}") from error
        if not isinstance(value, dict):
            raise RunFileError(f"{self.path.name}, line {self.rows} is not an object")
        return value


def is_locked(path: Path) -> bool:
    """Whether a living process holds the lock file `path`; a dead one never does, whatever its pid."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    except OSError:
        return False
    try:
        # A shared probe: two readers never take each other for a trainer.
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    finally:
        os.close(descriptor)
    return False


def take_lock(path: Path, patience_s: float = PROBE_PATIENCE_S) -> int | None:
    """The descriptor of the lock file `path`, ours until it is closed, or None when another process holds it.

    Patience covers the microseconds a reader's probe (`is_locked`) holds the lock.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
    deadline = time.monotonic() + patience_s
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return descriptor
        except BlockingIOError:
            if time.monotonic() > deadline:
                os.close(descriptor)
                return None
            time.sleep(0.002)


@contextlib.contextmanager
def waiting_lock(path: Path) -> Iterator[None]:
    """Hold the lock file `path`, waiting for whoever has it; for the launcher's short turns."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
