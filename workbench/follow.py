"""Watches running trainings from the terminal: one progress row per run, and what Ctrl-C means."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from typing import Any

from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from workbench.engine import Engine
from workbench.launcher import stop_now
from workbench.progress import console
from workbench.run_files import LineReader
from workbench.run_state import RunState
from workbench.runs import Run, RunBusyError
from workbench.terminal import duration, percent, printable

TICK_S = 0.25
END_PATIENCE_S = 10.0


def follow(engine: Engine, runs: Sequence[Run]) -> bool:
    """Show the runs on standard error until all have ended; returns whether the user asked them to stop.

    The first Ctrl-C asks them to stop at the end of their epoch, the second ends them at once.
    """
    watch = _Watch(engine, runs)
    asked = False
    with watch.progress:
        while True:
            try:
                if not watch.tick():
                    return asked
                time.sleep(TICK_S)
            except KeyboardInterrupt:
                if asked:
                    _end_at_once(engine, runs)
                    return True
                asked = True
                watch.say("stopping at the end of the epoch; Ctrl-C again to stop at once")
                _ask(runs)


class _Watch:
    """The rows on the screen and what each run has told so far."""

    def __init__(self, engine: Engine, runs: Sequence[Run]) -> None:
        self.progress = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=24),
            TextColumn("{task.percentage:>3.0f} %"),
            TextColumn("{task.fields[figures]}"),
            TimeElapsedColumn(),
            console=console(),
            disable=not sys.stderr.isatty(),
        )
        self._engine = engine
        self._runs = runs
        self._rows: dict[str, TaskID] = {}
        self._events = {run.id: LineReader(run.path / "events.jsonl") for run in runs}
        self._seen: set[str] = set()
        for run in runs:
            if run.state.resumes:
                self._new_events(run)
            self._rows[run.id] = self.progress.add_task(_name(run), total=1.0, figures="queued")

    def tick(self) -> bool:
        """Bring everything up to date; whether a run is still going on."""
        # Also starts the next in the queue should a training have died without doing so.
        self._engine.tick()
        states = [run.state for run in self._runs]
        for run, state in zip(self._runs, states, strict=True):
            for event in self._new_events(run):
                self.say(f"{_name(run)}: {printable(str(event.get('text', '')))}")
            description = printable(f"{_name(run)} {state.task}".strip())
            self.progress.update(
                self._rows[run.id], completed=state.progress, description=description, figures=_figures(state)
            )
        return any(state.active for state in states)

    def _new_events(self, run: Run) -> list[dict[str, Any]]:
        """Events that were not seen before; when a run is resumed its events are cut back and read again."""
        events = [(f"{run.id} {event.get('time')}", event) for event in self._events[run.id].read_new()]
        new = [event for stamp, event in events if stamp not in self._seen]
        self._seen.update(stamp for stamp, _ in events)
        return new

    def say(self, text: str) -> None:
        """A line above the rows."""
        self.progress.console.print(text, soft_wrap=True)


def _name(run: Run) -> str:
    variant = run.config.variant
    return f"seed {run.config.seed}" if variant == "submas" else f"{variant} seed {run.config.seed}"


def _figures(state: RunState) -> str:
    if state.state != "running":
        return state.state
    stage = f"stage {state.stage + 1}/{state.stages}  " if state.stages > 1 else ""
    return f"{stage}success {percent(state.best_success_rate)}  {duration(state.eta_s)} left"


def _ask(runs: Sequence[Run]) -> None:
    for run in runs:
        try:
            run.request_stop()
        except RunBusyError:
            continue


def _end_at_once(engine: Engine, runs: Sequence[Run]) -> None:
    deadline = time.monotonic() + END_PATIENCE_S
    for run in runs:
        stop_now(run)
    while any(run.is_alive() for run in runs) and time.monotonic() < deadline:
        engine.tick()
        time.sleep(0.05)
