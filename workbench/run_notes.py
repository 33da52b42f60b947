"""What a person writes about a run: a note and tags, in `notes.json` of its folder. Data, never markup."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from sim.errors import UsageError
from workbench.run_files import RunFileError, read_json, write_json

FILE = "notes.json"
NOTE_LIMIT = 10_000
TAG_LIMIT = 40
TAGS_LIMIT = 20


class NotesError(UsageError):
    """A note or a tag that is too long or holds what it may not; the sentence says what is legal."""


@dataclass(frozen=True)
class RunNotes:
    """What is written about one run."""

    text: str = ""
    """Free text of several lines."""
    tags: tuple[str, ...] = ()
    """Short words to find runs by, in the order they were given."""

    def __post_init__(self) -> None:
        """Reject what does not fit.

        Raises:
            NotesError: naming the note or the tag, and what is legal.
        """
        if len(self.text) > NOTE_LIMIT:
            raise NotesError(f"the note has {len(self.text)} characters; at most {NOTE_LIMIT} are legal")
        if len(self.tags) > TAGS_LIMIT:
            raise NotesError(f"these are {len(self.tags)} tags; a run has at most {TAGS_LIMIT}")
        for tag in self.tags:
            _check(tag)

    def with_tags(self, tags: Iterable[str]) -> RunNotes:
        """The same note with these tags added behind those it has."""
        return RunNotes(self.text, tuple(dict.fromkeys([*self.tags, *tags])))


def _check(tag: str) -> None:
    if not tag or len(tag) > TAG_LIMIT or not tag.isprintable() or "," in tag or tag != tag.strip():
        raise NotesError(f"tag {tag[:60]!r} is not legal: 1 to {TAG_LIMIT} printable characters without a comma")


def parse_tags(text: str) -> tuple[str, ...]:
    """Tags from "one, another": split at commas, trimmed, each once.

    Raises:
        NotesError: one of them is too long or not printable, or there are too many.
    """
    return RunNotes(tags=tuple(dict.fromkeys(filter(None, (tag.strip() for tag in text.split(",")))))).tags


def read_notes(folder: Path) -> RunNotes:
    """What is written about the run in this folder; nothing when nothing can be read.

    A damaged `notes.json` never makes a run unreadable.
    """
    with contextlib.suppress(RunFileError, NotesError):
        value = read_json(folder / FILE)
        text, tags = value.get("text", ""), value.get("tags", [])
        if isinstance(text, str) and isinstance(tags, list) and all(isinstance(tag, str) for tag in tags):
            return RunNotes(text, tuple(tags))
    return RunNotes()


def write_notes(folder: Path, notes: RunNotes) -> None:
    """Replace what is written about the run in this folder, as a whole or not at all.

    Raises:
        RunFileError: the folder cannot be written.
    """
    write_json(folder / FILE, {"text": notes.text, "tags": list(notes.tags)})
