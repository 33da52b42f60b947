"""What a reproduction shows on standard error: how far it is, what trains now, and how long the rest will take."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType

from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from workbench.progress import console
from workbench.reproduce.trainings import words
from workbench.runs import Run
from workbench.terminal import duration, percent, printable


@dataclass(frozen=True)
class Standing:
    """How far a reproduction is."""

    trained: int
    trainings: int
    flown: int
    evaluations: int
    left_s: float
    """Estimated time until all is done [s]."""
    running: Sequence[Run]

    @property
    def share(self) -> float:
        """Share of all work that is done, 0 to 1."""
        if not self.trainings:
            return self.flown / self.evaluations if self.evaluations else 1.0
        # A training weighs as much as the evaluations of a few hundred policies.
        return (self.trained + sum(run.state.progress for run in self.running)) / self.trainings

    @property
    def summary(self) -> str:
        """In a few words."""
        parts = [f"{self.trained}/{self.trainings} trained"] if self.trainings else []
        parts += [f"{self.flown}/{self.evaluations} evaluated"] if self.evaluations else []
        return ", ".join([*parts, f"about {duration(self.left_s)} left"])


class Watch:
    """Rows on the terminal; only its lines where standard error is not one."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TextColumn("{task.percentage:>3.0f} %"),
            TextColumn("{task.fields[figures]}"),
            TimeElapsedColumn(),
            console=console(),
            transient=True,
            disable=not sys.stderr.isatty(),
        )
        self._whole = self._progress.add_task("all", total=1.0, figures="")
        self._rows: dict[str, TaskID] = {}

    def __enter__(self) -> Watch:
        """Begin to draw."""
        self._progress.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Leave the terminal as it was."""
        self._progress.stop()

    def say(self, text: str) -> None:
        """A line above the rows, also where there are none."""
        self._progress.console.print(printable(text), soft_wrap=True)

    def show(self, standing: Standing) -> None:
        """Bring the rows up to date."""
        self._progress.update(self._whole, completed=standing.share, figures=standing.summary)
        for run_id in set(self._rows) - {run.id for run in standing.running}:
            self._progress.remove_task(self._rows.pop(run_id))
        for run in standing.running:
            self._show_run(run)

    def _show_run(self, run: Run) -> None:
        if run.id not in self._rows:
            self._rows[run.id] = self._progress.add_task(words(run.config), total=1.0, figures="")
        state = run.state
        figures = f"{state.task} success {percent(state.best_success_rate)}" if state.task else state.state
        self._progress.update(self._rows[run.id], completed=state.progress, figures=figures)
