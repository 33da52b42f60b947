"""The manifest of a checkpoint: written last, it names every part with size and digest, and carries its own digest."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.errors import SubMasError
from workbench.run_files import RunFileError, open_plain, read_json, write_bytes

SCHEMA = 1
PART_NAME = re.compile(r"(state|replay)-[0-9]{6}(-[0-9])?\.safetensors")
MANIFEST_NAME = re.compile(r"manifest-([0-9]{6})\.json")


class CheckpointError(SubMasError):
    """A checkpoint is damaged, or none of several is whole; the message names the file and the reason."""

    exit_code = 3


@dataclass(frozen=True)
class Part:
    """One file of a checkpoint."""

    name: str
    bytes: int
    sha256: str
    first: int = -1
    """Number of its first time slot, if it holds experience."""


@dataclass(frozen=True)
class Manifest:
    """What a checkpoint consists of."""

    run: str
    number: int
    stage: int
    values: dict[str, Any]
    """The snapshot's values."""
    facts: dict[str, Any]
    """What the run's files looked like: state, lengths, versions."""
    added: int | None
    """Time slots of experience stored so far; None without any."""
    parts: tuple[Part, ...]
    schema: int = SCHEMA

    @property
    def name(self) -> str:
        """Name of its file."""
        return manifest_name(self.number)

    def write(self, folder: Path) -> None:
        """Write it; from then on the checkpoint counts.

        Raises:
            RunFileError: it could not be written, or a number in it is not finite.
        """
        content = dataclasses.asdict(self)
        try:
            data = json.dumps({"sha256": _digest(content), "checkpoint": content}, indent=1, allow_nan=False)
        except ValueError as error:
            raise RunFileError(f"cannot save {folder / self.name}: a number is not finite ({error})") from error
        write_bytes(folder / self.name, data.encode())


def manifest_name(number: int) -> str:
    """File name of a manifest."""
    return f"manifest-{number:06}.json"


def manifest_numbers(folder: Path) -> list[int]:
    """Numbers of all manifests in a folder, newest first."""
    try:
        found = [MANIFEST_NAME.fullmatch(name) for name in os.listdir(folder)]
    except FileNotFoundError:
        return []
    except OSError as error:
        raise CheckpointError(f"{folder} cannot be read: {error.strerror}") from error
    return sorted((int(match[1]) for match in found if match), reverse=True)


def read_manifest(folder: Path, number: int, run: str) -> Manifest:
    """A manifest whose parts are all there, whole, and of this run.

    Raises:
        CheckpointError: naming the file and what is wrong with it.
    """
    path = folder / manifest_name(number)
    try:
        content = read_json(path, follow=False)
    except RunFileError as error:
        raise CheckpointError(str(error)) from error
    manifest = _parse(path.name, content)
    if manifest.run != run or manifest.number != number:
        raise CheckpointError(f"{path.name} belongs to checkpoint {manifest.number} of run {manifest.run[:40]}")
    for part in manifest.parts:
        _check_part(folder, part)
    return manifest


def _parse(name: str, content: dict[str, Any]) -> Manifest:
    checkpoint = content.get("checkpoint")
    if not isinstance(checkpoint, dict):
        raise CheckpointError(f"{name} is not the manifest of a checkpoint")
    if checkpoint.get("schema") != SCHEMA:
        schema = str(checkpoint.get("schema"))[:20]
        raise CheckpointError(f"{name} has format {schema}, this version reads {SCHEMA}; use the version that wrote it")
    if content.get("sha256") != _digest(checkpoint):
        raise CheckpointError(f"{name} is damaged: its digest does not match")
    try:
        parts = tuple(Part(**part) for part in checkpoint["parts"])
        manifest = Manifest(**{**checkpoint, "parts": parts})
    except (TypeError, KeyError) as error:
        raise CheckpointError(f"{name} is not the manifest of a checkpoint: {error}") from error
    for part in manifest.parts:
        if not PART_NAME.fullmatch(part.name):
            raise CheckpointError(f"{name} names a part that is none: {part.name[:40]!r}")
    return manifest


def _check_part(folder: Path, part: Part) -> None:
    try:
        with open_plain(folder / part.name) as file:
            size = os.fstat(file.fileno()).st_size
            if size != part.bytes:
                raise CheckpointError(f"{part.name} is {size} bytes long, {part.bytes} were written")
            if hashlib.file_digest(file, "sha256").hexdigest() != part.sha256:
                raise CheckpointError(f"{part.name} is damaged: its digest does not match")
    except OSError as error:
        raise CheckpointError(f"{part.name} cannot be read: {error.strerror}") from error


def _digest(content: dict[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
