"""Runs under way, on the page that launches them: how each stands, and the way to watch it."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Sequence
from pathlib import Path

import panel as pn

from sim.errors import SubMasError
from workbench.pages.address import search
from workbench.pages.curriculum_cost import long
from workbench.policies import title
from workbench.run_state import RunState
from workbench.runs import Run, RunStore

TICK_MS = 1000
SIGNS = {
    "queued": "…", "running": "▶", "stalled": "!", "paused": "‖", "stopped": "■", "finished": "✓", "failed": "✗",
    "interrupted": "✗",
}  # fmt: skip
RUNS_CSS = Path(__file__).with_suffix(".css").read_text("utf-8")


class LaunchedRuns:
    """The runs that were alive when the page was opened, and those launched since."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._shown: list[str] = [run.id for run in store.list() if not run.problem and run.state.active]
        self.pane = pn.pane.HTML("", stylesheets=[RUNS_CSS], sizing_mode="stretch_width", margin=0, visible=False)
        self._draw(self._rows())
        if pn.state.curdoc is not None:
            pn.state.add_periodic_callback(self._tick, TICK_MS)

    def add(self, runs: Sequence[Run]) -> None:
        """Show these as well, above the others."""
        self._shown = [run.id for run in runs] + self._shown
        self._draw(self._rows())

    async def _tick(self) -> None:
        if self._shown:
            self._draw(await asyncio.to_thread(self._rows))

    def _rows(self) -> list[tuple[Run, RunState]]:
        rows = []
        for run_id in self._shown:
            try:
                run = self._store.get(run_id)
                rows.append((run, run.state))
                _ = run.config
            except SubMasError:
                continue  # deleted or damaged in the meantime: the Runs page says more
        return rows

    def _draw(self, rows: Sequence[tuple[Run, RunState]]) -> None:
        text = runs_list(rows)
        if text != self.pane.object:
            self.pane.object, self.pane.visible = text, bool(rows)


def runs_list(rows: Sequence[tuple[Run, RunState]]) -> str:
    """The runs as HTML, one line each."""
    alive = sum(state.active for _, state in rows)
    lines = "".join(_line(run, state) for run, state in rows)
    heading = f"Runs under way ({alive} of {len(rows)})" if alive else "Runs launched from here"
    return f'<div class="runs"><h2>{heading}</h2><ul>{lines}</ul></div>'


def _line(run: Run, state: RunState) -> str:
    name = html.escape(title(run.config))
    done = f'<span class="bar"><i style="width:{100 * state.progress:.0f}%"></i></span>'
    left = f"at most {long(state.eta_s)} left" if state.active and state.eta_s is not None else ""
    href = "/live" + search({"run": run.id, "theme": _theme()})
    return (
        f'<li><span class="state {state.state}">{SIGNS.get(state.state, "·")} {state.state}</span>'
        f'<span class="what" title="{name}">{name}</span>{done}'
        f'<span class="left">{left}</span>'
        f'<a href="{href}" aria-label="Watch {name} on the Live page">Open in Live</a></li>'
    )


def _theme() -> str:
    """`default` on a light page, so that the next one is light too."""
    location = pn.state.location
    return "default" if location is not None and "theme=default" in location.search else ""
