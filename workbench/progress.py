"""Progress bars with remaining time, on standard error, so that standard output holds results alone."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from workbench.terminal import printable

Update = Callable[[int, int], None]
"""Called with how much is done and how much there is."""


def console() -> Console:
    """The terminal behind standard error."""
    return Console(file=sys.stderr, highlight=False, markup=False)


class Bar:
    """A running progress bar: call it with how much is done and how much there is."""

    def __init__(self, progress: Progress, task: TaskID) -> None:
        self._progress, self._task = progress, task

    def __call__(self, done: int, total: int) -> None:
        """Move the bar."""
        self._progress.update(self._task, completed=done, total=total)

    def say(self, line: str) -> None:
        """Print a line above the bar; also where standard error is not a terminal and there is no bar."""
        self._progress.console.print(printable(line), soft_wrap=True)


@contextlib.contextmanager
def bar(description: str, unit: str = "") -> Iterator[Bar]:
    """A progress bar while the block runs; silent when standard error is not a terminal."""
    screen = console()
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TextColumn(unit),
               TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn())  # fmt: skip
    # Work of one kind may come in lumps of a minute: the speed is that of the last five.
    with Progress(
        *columns, console=screen, transient=True, disable=not screen.is_terminal, speed_estimate_period=300.0
    ) as progress:
        yield Bar(progress, progress.add_task(printable(description), total=None))
