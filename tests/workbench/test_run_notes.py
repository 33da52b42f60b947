"""Notes and tags of a run are data in its folder: kept whole, bounded, never in the way of the run."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.run_files import write_json
from workbench.run_notes import FILE, NOTE_LIMIT, NotesError, RunNotes, parse_tags, read_notes, write_notes

HOSTILE = "<script>alert(1)</script>\n=HYPERLINK(1) {{7*7}}"


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    notes = RunNotes(HOSTILE, ("keep", "<b>x</b>", "ü"))
    write_notes(tmp_path, notes)
    assert read_notes(tmp_path) == notes
    assert [path.name for path in tmp_path.iterdir()] == [FILE]


def test_no_file_is_no_notes(tmp_path: Path) -> None:
    assert read_notes(tmp_path) == RunNotes()
    assert read_notes(tmp_path / "nowhere") == RunNotes()


@pytest.mark.parametrize(
    "value", [{"text": 3}, {"tags": "keep"}, {"tags": [1]}, {"tags": ["a,b"]}, {"text": "x" * 20_000}]
)
def test_damaged_notes_are_no_notes(value: dict[str, object], tmp_path: Path) -> None:
    write_json(tmp_path / FILE, value)
    assert read_notes(tmp_path) == RunNotes()


def test_tags_are_split_trimmed_and_each_given_once() -> None:
    assert parse_tags(" keep, two words ,,keep, ü ") == ("keep", "two words", "ü")
    assert parse_tags("") == ()


@pytest.mark.parametrize("text", ["x" * 41, "a\x1b[31mb", "a\nb", ",".join(map(str, range(21)))])
def test_a_tag_that_does_not_fit_is_a_sentence(text: str) -> None:
    with pytest.raises(NotesError, match=r"tags?") as refused:
        parse_tags(text)
    assert len(str(refused.value)) < 200


def test_a_note_that_is_too_long_is_a_sentence() -> None:
    with pytest.raises(NotesError, match="10001 characters; at most 10000"):
        RunNotes("x" * (NOTE_LIMIT + 1))


def test_tags_are_added_behind() -> None:
    assert RunNotes("n", ("a", "b")).with_tags(["c", "a"]) == RunNotes("n", ("a", "b", "c"))
