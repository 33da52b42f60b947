"""Checkpoints of one run: `checkpoints/` holds the last two, so that one is whole whatever happens while saving.

A checkpoint is `state-N.safetensors` (networks, moments, generators, worlds), the run's `replay-M.safetensors` as far
as its ring reaches back, each holding the experience of one or a few epochs and written once, and `manifest-N.json`,
written last. A checkpoint counts from the moment its manifest is there.
"""

from __future__ import annotations

import contextlib
import hashlib
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents import disk
from workbench.checkpoint_manifest import (
    MANIFEST_NAME,
    PART_NAME,
    CheckpointError,
    Manifest,
    Part,
    manifest_name,
    manifest_numbers,
    read_manifest,
)
from workbench.run_files import RunFileError, open_plain, write_bytes

if TYPE_CHECKING:
    from agents.replay import StoredSlots
    from agents.snapshot import Snapshot

__all__ = ["Checkpoint", "CheckpointError", "Checkpoints"]

KEPT = 2


@dataclass(frozen=True)
class Checkpoint:
    """A whole checkpoint, read."""

    number: int
    snapshot: Snapshot
    facts: Mapping[str, Any]
    refused: tuple[str, ...]
    """Why newer ones could not be taken, a sentence each."""


class Checkpoints:
    """Writes and reads the checkpoints of one run; only the process that holds the run's lock may write."""

    def __init__(self, folder: Path, run: str) -> None:
        self.folder = folder
        self._run = run
        self._kept: tuple[Manifest, ...] = ()
        """Those known to be whole, oldest first."""

    def save(self, snapshot: Snapshot, facts: Mapping[str, Any]) -> None:
        """Write a checkpoint, then remove what none of the last two needs.

        Raises:
            RunFileError: it could not be written; the one before is still whole, and nothing half is left.
        """
        number = self._kept[-1].number + 1 if self._kept else 1
        written: list[Path] = []
        try:
            self.folder.mkdir(exist_ok=True)
            parts = list(self._write_parts(snapshot, number, written))
            added = snapshot.slots.added if snapshot.slots else None
            manifest = Manifest(
                self._run, number, snapshot.stage, dict(snapshot.values), dict(facts), added, tuple(parts)
            )
            manifest.write(self.folder)
        except BaseException as error:
            # The manifest first, should it be there already: one without its parts would be a damaged checkpoint.
            with contextlib.suppress(OSError):
                for path in (self.folder / manifest_name(number), *written):
                    disk.disk.remove(path)
            if isinstance(error, OSError):
                raise RunFileError(f"cannot save {self.folder}: {error.strerror}") from error
            raise
        self._kept = (*self._kept, manifest)[-KEPT:]
        self._remove_unneeded()

    def latest(self) -> Checkpoint | None:
        """The newest checkpoint that is whole; None if the run has never saved one.

        Raises:
            CheckpointError: there are some, and all are damaged.
        """
        refused: list[str] = []
        for number in manifest_numbers(self.folder):
            try:
                manifest = read_manifest(self.folder, number, self._run)
                snapshot = self._snapshot(manifest)
            except CheckpointError as error:
                refused.append(f"checkpoint {number} cannot be used: {error}")
                continue
            self._kept = (manifest,)
            return Checkpoint(number, snapshot, manifest.facts, tuple(refused))
        if refused:
            raise CheckpointError(f"run {self._run} has no whole checkpoint: {'; '.join(refused)}")
        return None

    def clear(self) -> None:
        """Remove all of them: the run is finished."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self._kept = ()

    def _write_parts(self, snapshot: Snapshot, number: int, written: list[Path]) -> Iterator[Part]:
        yield self._write_part(f"state-{number:06}.safetensors", snapshot.arrays, -1, written)
        if snapshot.slots is None:
            return
        earlier, since = self._experience(snapshot.stage)
        oldest = next((first for first, _ in snapshot.slots.blocks(0)), 0)
        new = [
            self._write_part(f"replay-{number:06}-{index}.safetensors", {"rows": rows}, first, written)
            for index, (first, rows) in enumerate(snapshot.slots.blocks(since))
        ]
        everything = [*earlier, *new]
        # What lies wholly before the ring's oldest slot has been overwritten there, too.
        yield from (part for part, after in pairwise(everything) if after.first > oldest)
        yield from everything[-1:]

    def _write_part(self, name: str, arrays: Mapping[str, Any], first: int, written: list[Path]) -> Part:
        import numpy as np
        from safetensors.numpy import save

        # `ascontiguousarray` would give a number an axis.
        data = save({key: np.asarray(array, order="C") for key, array in arrays.items()})
        path = self.folder / name
        written.append(path)
        write_bytes(path, data)
        return Part(name, len(data), hashlib.sha256(data).hexdigest(), first)

    def _experience(self, stage: int) -> tuple[list[Part], int]:
        """Parts with experience of this stage that are there already, and the number of the next time slot."""
        if not self._kept or self._kept[-1].stage != stage:
            return [], 0
        last = self._kept[-1]
        return [part for part in last.parts if part.first >= 0], last.added or 0

    def _remove_unneeded(self) -> None:
        needed = {manifest.name for manifest in self._kept}
        needed |= {part.name for manifest in self._kept for part in manifest.parts}
        names = [path.name for path in self.folder.iterdir() if path.name not in needed]
        ours = [name for name in names if MANIFEST_NAME.fullmatch(name) or PART_NAME.fullmatch(name)]
        try:
            for name in sorted(ours):  # manifests first: "m" sorts before "replay" and "state"
                disk.disk.remove(self.folder / name)
        except OSError as error:
            raise RunFileError(f"cannot remove an old checkpoint in {self.folder}: {error.strerror}") from error

    def _snapshot(self, manifest: Manifest) -> Snapshot:
        from agents.snapshot import Snapshot

        state, *experience = manifest.parts
        slots: StoredSlots | None = None
        if manifest.added is not None:
            slots = _Experience(self.folder, manifest.added, tuple(experience))
        return Snapshot(manifest.stage, manifest.values, _arrays(self.folder / state.name), slots)


@dataclass(frozen=True)
class _Experience:
    """Experience on disk, read part by part as it is asked for: a `StoredSlots`."""

    folder: Path
    added: int
    parts: tuple[Part, ...]

    def blocks(self, first: int) -> Iterator[tuple[int, Any]]:
        """Blocks of consecutive slots from number `first` on, oldest first."""
        ends = [part.first for part in self.parts[1:]] + [self.added]
        for part, end in zip(self.parts, ends, strict=True):
            if end > first:
                yield part.first, _arrays(self.folder / part.name)["rows"]


def _arrays(path: Path) -> dict[str, Any]:
    from safetensors import SafetensorError
    from safetensors.numpy import load

    try:
        with open_plain(path) as file:
            return load(file.read())
    except OSError as error:
        raise CheckpointError(f"{path.name} cannot be read: {error.strerror}") from error
    except (SafetensorError, KeyError, ValueError, TypeError) as error:
        raise CheckpointError(f"{path.name} is not a part of a checkpoint: {error}") from error
