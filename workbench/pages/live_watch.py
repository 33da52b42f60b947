"""Reads a growing run piece by piece for a page that looks twice a second."""

from __future__ import annotations

from typing import Any

from workbench.run_files import LineReader, RunFileError
from workbench.runs import Run


class RunWatch:
    """Rows and events of one run so far; `look` says whether anything has changed."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.rows: list[dict[str, Any]] = []
        self.events: list[dict[str, Any]] = []
        self.problem = ""
        self._metrics = LineReader(run.path / "metrics.jsonl")
        self._event_lines = LineReader(run.path / "events.jsonl")
        self._seen: object = None

    def look(self) -> bool:
        """Read what is new; True when something is (always at the first look)."""
        seen = self.run.signature()
        if seen == self._seen:
            return False
        self._seen = seen
        try:
            rows = [_checked(row) for row in self._metrics.read_new()]
            self.rows = rows if self._metrics.anew else self.rows + rows
            events = self._event_lines.read_new()
            self.events = events if self._event_lines.anew else self.events + events
        except RunFileError as error:
            self.problem = str(error)
        return True


def _checked(row: dict[str, Any]) -> dict[str, Any]:
    """The row, if it says which epoch of which stage it is about.

    Raises:
        RunFileError: it does not.
    """
    numbers = ("stage", "stages", "epoch", "epochs")
    if not all(isinstance(row.get(name), int) for name in numbers) or not isinstance(row.get("task"), str):
        raise RunFileError(f"metrics.jsonl has a row without {', '.join(numbers)} and task")
    return row
