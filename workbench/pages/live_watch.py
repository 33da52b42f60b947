"""Reads a growing run piece by piece: only what was written since the last look, kept as columns of numbers."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from typing import Any, Final

from layouts.learning_panels import PANELS
from workbench.run_files import LineReader, RunFileError
from workbench.runs import Run
from workbench.stages import summarise

COUNTERS: Final = ("stage", "epoch", "env_steps", "wall_s", "length_mean_s")
NAMES: Final = (*COUNTERS, *(curve.name for panel in PANELS for curve in panel.curves))
"""Figures of a metrics row that are kept."""


class RunWatch:
    """Figures and events of one run so far; `look` says whether anything has changed."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.columns: dict[str, array[float]] = {name: array("d") for name in NAMES}
        """By name, one value per epoch; NaN where it was not measured."""
        self.tasks: list[str] = []
        """The task of each epoch."""
        self.last: dict[str, Any] | None = None
        """The latest metrics row."""
        self.events: list[dict[str, Any]] = []
        self.problem = ""
        self.anew = 0
        """How often what was read became void: a resumed run forgets what its checkpoint did not know."""
        self._metrics = LineReader(run.path / "metrics.jsonl")
        self._event_lines = LineReader(run.path / "events.jsonl")
        self._seen: object = None

    def look(self) -> bool:
        """Read what is new; True when something is (always at the first look)."""
        seen = (self.run.signature(), self.run.pause_requested(), self.run.stop_requested())
        if seen == self._seen:
            return False
        self._seen, self.problem = seen, ""
        try:
            self._take(self._metrics.read_new())
            events = self._event_lines.read_new()
            self.events = events if self._event_lines.anew else self.events + events
        except RunFileError as error:
            self.problem = str(error)
        return True

    def _take(self, rows: list[dict[str, Any]]) -> None:
        if self._metrics.anew:
            self.anew += 1
            self.tasks, self.last = [], None
            for column in self.columns.values():
                del column[:]
        for row in rows:
            self.last = _checked(row)
            self.tasks.append(row["task"])
            for name, column in self.columns.items():
                column.append(guide_share(row) if name == "guide_share" else _number(row.get(name)))

    def stages(self) -> list[dict[str, Any]]:
        """What each begun stage has reached, as `workbench.stages.summarise` has it."""
        return summarise(self._rows())

    def _rows(self) -> Iterator[dict[str, Any]]:
        names = ("stage", "epoch", "success_rate", "wall_s")
        for task, stage, epoch, success, wall_s in zip(
            self.tasks, *(self.columns[name] for name in names), strict=True
        ):
            known = None if success != success else success
            yield {"task": task, "stage": int(stage), "epoch": int(epoch), "success_rate": known, "wall_s": wall_s}


def guide_share(row: Mapping[str, Any]) -> float:
    """Share of an epoch's steps that the guide flew, 0..1 (Eq. 18); NaN where it was not measured.

    Trainings of earlier versions did not count it. There it is what is to be expected: ε by the share with transfer, as
    the draw of ε does not look at the state.
    """
    if "guide_share" in row:
        return _number(row["guide_share"])
    return _number(row.get("epsilon")) * _number(row.get("transfer_share"))


def _number(value: object) -> float:
    fits = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
    return float(value) if fits else float("nan")  # type: ignore[arg-type]


def _checked(row: dict[str, Any]) -> dict[str, Any]:
    """The row, if it says which epoch of which stage it is about.

    Raises:
        RunFileError: it does not.
    """
    numbers = ("stage", "stages", "epoch", "epochs")
    if not all(isinstance(row.get(name), int) for name in numbers) or not isinstance(row.get("task"), str):
        raise RunFileError(f"metrics.jsonl has a row without {', '.join(numbers)} and task")
    return row
