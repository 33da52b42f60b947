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
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

Update = Callable[[int, int], None]
"""Called with how much is done and how much there is."""


def console() -> Console:
    """The terminal behind standard error."""
    return Console(file=sys.stderr, highlight=False, markup=False)


@contextlib.contextmanager
def bar(description: str, unit: str = "") -> Iterator[Update]:
    """A progress bar while the block runs; silent when standard error is not a terminal."""
    screen = console()
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn(unit),
               TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn())  # fmt: skip
    with Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as progress:
        task = progress.add_task(description, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)
