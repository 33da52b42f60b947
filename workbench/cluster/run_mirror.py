"""A node's side of streaming: brings the copy at the head to what the run folder here holds, piece by piece.

What is read last is sent first: manifests and state are read before the files they speak of, and sent after them. So
the copy is at every moment one from which the run can go on, whenever node or network dies.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, Protocol

from workbench.checkpoint_manifest import MANIFEST_NAME
from workbench.run_files import RunFileError, Signature, signature

PIECE_BYTES: Final = 4 * 2**20
"""Most that travels in one message."""
CHECKPOINT_SHARE: Final = 0.2
"""Largest share of the time that goes into sending checkpoints: where the way is slow or full, fewer are sent, and no
experience that the ring has overwritten by then."""
LINES: Final = ("metrics.jsonl", "events.jsonl", "log.txt")
"""Files that grow."""
WHOLE: Final = ("policy.safetensors", "policy.json")
"""Files that are replaced."""


class Head(Protocol):
    """The receiver of one attempt at one run."""

    def call(self, method: str, *values: Any) -> Any:
        """Call a method of `RunReceiver`, with run and attempt before these values."""
        ...


class RunMirror:
    """One run folder of this node and its copy at the head."""

    def __init__(self, folder: Path, head: Head) -> None:
        self._folder = folder
        self._head = head
        self._sent: dict[str, Signature] = {}
        self._lines: dict[str, tuple[int, int]] = {}
        """Inode and length of each growing file when it was sent last."""
        self._kept: list[str] | None = None
        self._due_s = 0.0
        """When checkpoints are sent again, by the monotonic clock [s]."""

    def fetch(self) -> None:
        """Fill the empty folder with what the head has."""
        for name, size in self._head.call("files").items():
            path = self._folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("wb") as file:
                while file.tell() < size:
                    piece = self._head.call("read", name, file.tell(), min(PIECE_BYTES, size - file.tell()))
                    if not piece:
                        raise RunFileError(f"{name} is shorter than it was")
                    file.write(piece)
            self._sent[name], self._lines[name] = signature(path), (signature(path)[2], size)

    def send(self, last: bool = False) -> None:
        """Send what has changed since the last time; the last time, all of it."""
        state = _read(self._folder / "state.json")
        due = last or time.monotonic() >= self._due_s
        manifests = {name: data for name in self._manifests() if (data := _read(self._folder / name))} if due else {}
        for name in LINES:
            self._send_lines(name)
        for name in (*sorted(f"policies/{path.name}" for path in (self._folder / "policies").glob("[!.]*")), *WHOLE):
            self._send_changed(name)
        if due:
            began_s = time.monotonic()
            self._send_checkpoints(manifests)
            self._due_s = time.monotonic() + (time.monotonic() - began_s) / CHECKPOINT_SHARE
        self._send_state(state)

    def _send_checkpoints(self, manifests: dict[str, bytes]) -> None:
        kept: list[str] = []
        for name, data in sorted(manifests.items()):
            parts = [f"checkpoints/{part}" for part in _parts(data)]
            # One that vanishes while it is being read belongs to a checkpoint that is no longer needed.
            if all([self._send_changed(part) for part in parts]):
                if self._sent.get(name) != (0, len(data), hash(data)):
                    self._put(name, data)
                    self._sent[name] = (0, len(data), hash(data))
                kept += [*parts, name]
        if kept != self._kept and (kept or not manifests):
            self._head.call("keep_checkpoints", kept)
            self._kept = kept

    def _send_state(self, state: bytes) -> None:
        if state and self._sent.get("state.json") != (0, len(state), hash(state)):
            self._head.call("state", json.loads(state))
            self._sent["state.json"] = (0, len(state), hash(state))

    def _send_lines(self, name: str) -> None:
        """What was added to a growing file; the whole file if it was cut back."""
        try:
            with (self._folder / name).open("rb") as file:
                inode, data = os.fstat(file.fileno()).st_ino, file.read()
        except FileNotFoundError:
            return
        sent_inode, sent = self._lines.get(name, (inode, 0))
        if (inode, len(data)) == (sent_inode, sent):
            return
        grown = inode == sent_inode and sent <= len(data)
        if not (grown and all(self._append(name, *piece) for piece in _pieces(data, sent))):
            self._put(name, data)
        self._lines[name] = (inode, len(data))

    def _append(self, name: str, offset: int, data: bytes) -> bool:
        return self._head.call("append", name, offset, data)

    def _send_changed(self, name: str) -> bool:
        """Send a file unless the head has it; whether it has it now."""
        path = self._folder / name
        found = signature(path)
        if not any(found):
            return False
        if found != self._sent.get(name):
            data = _read(path)
            if not data:
                return False
            self._put(name, data)
            self._sent[name] = found
        return True

    def _put(self, name: str, data: bytes) -> None:
        for offset, piece in _pieces(data, 0) if data else [(0, b"")]:
            self._head.call("put", name, offset, piece, offset + len(piece) == len(data))

    def _manifests(self) -> list[str]:
        names = [path.name for path in (self._folder / "checkpoints").glob("manifest-*")]
        return [f"checkpoints/{name}" for name in names if MANIFEST_NAME.fullmatch(name)]


def _read(path: Path) -> bytes:
    """All of a file, nothing if it is not there."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return b""


def _pieces(data: bytes, start: int) -> Iterator[tuple[int, bytes]]:
    for offset in range(start, len(data), PIECE_BYTES):
        yield offset, data[offset : offset + PIECE_BYTES]


def _parts(manifest: bytes) -> list[str]:
    """Names of the files that a manifest lists; who reads the copy checks it with all distrust."""
    return [str(part["name"]) for part in json.loads(manifest)["checkpoint"]["parts"]]
