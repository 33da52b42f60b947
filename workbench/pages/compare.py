"""The Compare page: any policies on any tasks, how they fared, where they failed, and a way to look at each failure."""

from __future__ import annotations

import asyncio
import contextlib
import html
from dataclasses import replace
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.comparison_inks import policy_inks
from sim.errors import SubMasError
from workbench.comparison.closely import Closely, look_closely
from workbench.comparison.grid import Grid, build_grid
from workbench.comparison.policies import comparison_choices
from workbench.comparison.work import Work
from workbench.context import AppContext
from workbench.pages.address import read_query, write_query
from workbench.pages.compare_bars import CompareBars
from workbench.pages.compare_closer import CompareCloser
from workbench.pages.compare_controls import CompareControls
from workbench.pages.compare_downloads import CompareDownloads
from workbench.pages.compare_progress import CompareProgress
from workbench.pages.compare_settings import CompareSettings, read_settings
from workbench.pages.compare_words import COMPARE_CSS
from workbench.pages.one_change import one_change
from workbench.pages.waiting import waiting
from workbench.pages.wrapping import wrapping
from workbench.scenarios import scenario_choices

TICK_MS = 250
UNASKED = 1000
"""The two policies that are looked at closely fly their task without being asked, up to so many engagements each."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Compare page of one session."""
    return ComparePage(context).layout


class ComparePage:
    """Controls, bars and closer look of one session, and the work it has asked for."""

    def __init__(self, context: AppContext) -> None:
        self._context, self._queue = context, context.comparisons
        self._labels = {spec: label for label, spec in comparison_choices(context.store).items()}
        scenarios = scenario_choices(context.store)
        self._settings, problems = read_settings(read_query(), self._labels, scenarios.values())
        self._request = 0
        self._held = False
        self._grid: Grid | None = None
        self._controls = CompareControls(self._settings, self._labels, scenarios, self._choose)
        self._progress = CompareProgress(self._queue, self._fly, self._cancel)
        self._bars, self._closer, self._downloads = CompareBars(self._look), CompareCloser(), CompareDownloads()
        self._alert = pmui.Alert(object="", severity="warning", visible=False, margin=0, sizing_mode="stretch_width")
        self._notes = pn.pane.HTML("", stylesheets=[COMPARE_CSS], margin=0, sizing_mode="stretch_width")
        self._waiting = waiting("Reading what has been flown so far …")
        self._bars.figures.visible = self._closer.layout.visible = False
        self.layout = self._arrange()
        self._complain(" ".join(problems))
        pn.state.execute(self._set_out)
        pn.state.onload(self._refresh)
        callback = pn.state.add_periodic_callback(self._tick, TICK_MS)
        pn.state.on_session_destroyed(lambda _session: self._leave(callback))

    def _leave(self, callback: Any) -> None:
        callback.stop()
        self._queue.leave(self)

    def _arrange(self) -> pn.viewable.Viewable:
        def row(items: list[pn.viewable.Viewable]) -> pn.viewable.Viewable:
            return wrapping(*items, gap="14px", align="end")

        return pn.Column(
            row(self._controls.what), row([*self._controls.how, *self._progress.items]), self._alert,
            self._waiting, self._bars.legend, self._bars.figures, self._notes,
            row([*self._controls.closely, self._downloads.layout]), self._closer.layout,
            sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "12px"},
        )  # fmt: skip

    def _choose(self) -> None:
        """Something else was chosen."""
        self._settings, self._held = self._controls.settings(), False
        self._complain("")
        pn.state.execute(self._refresh, schedule=True)

    def _look(self, policy: str, task: str) -> None:
        """A bar was clicked: look at it closely."""
        against = self._settings.policy if policy == self._settings.against else self._settings.against
        self._controls.fill(replace(self._settings, policy=policy, task=task, against=against))
        self._choose()

    def _fly(self) -> None:
        if self._grid is not None:
            self._held = False
            self._want(self._grid.unflown())

    def _cancel(self) -> None:
        self._held = True  # what is looked at closely is not flown again at once
        self._queue.drop(self._progress.pending, self)
        self._progress.forget()  # another page may still wait for some of it
        self._tell()

    def _join(self, works: list[Work]) -> None:
        """Wait for what another page has asked for."""
        self._queue.want(works, asker=self)
        self._progress.add(works)

    def _want(self, works: list[Work], *, soon: bool = False) -> None:
        self._queue.want(works, soon=soon, asker=self)
        self._progress.add(works)
        self._tell()

    async def _set_out(self) -> None:
        """What flies without being asked sets out while the browser still reads the page."""
        with contextlib.suppress(SubMasError):  # the page will complain of it
            _, close = await asyncio.to_thread(self._read, self._settings)
            self._queue.want(self._unasked(close), soon=True, asker=self)

    async def _refresh(self) -> None:
        """Read what is known, and show it."""
        self._request = number = self._request + 1
        settings = self._settings
        try:
            grid, close = await asyncio.to_thread(self._read, settings)
        except SubMasError as error:
            pn.state.execute(partial(self._complain, f"{error}."), schedule=True)
            return
        if number == self._request:
            # Figures may only be changed while the session's document is locked, which it is in a scheduled call.
            pn.state.execute(partial(self._show, settings, grid, close), schedule=True)

    def _read(self, settings: CompareSettings) -> tuple[Grid, Closely | None]:
        cache, store = self._queue.cache, self._context.store
        what = (settings.scenario, settings.episodes, settings.seed)
        grid = build_grid(settings.policies, settings.tasks, *what, store, cache)
        if not settings.task:
            return grid, None
        names = self._labels[settings.policy], self._labels[settings.against]
        return grid, look_closely(grid, settings.task, (settings.policy, settings.against), names, cache)

    @one_change()
    def _show(self, settings: CompareSettings, grid: Grid, close: Closely | None) -> None:
        self._grid = grid
        self._waiting.visible, self._bars.figures.visible = False, True
        inks = policy_inks(settings.policies)
        self._bars.show(grid, self._labels, inks)
        self._closer.layout.visible = close is not None
        if close is not None:
            theme = read_theme()
            self._closer.show(grid, settings, close, self._labels, inks, theme)
        self._downloads.offer(grid, close, settings, self._labels, inks)
        notes = "".join(f"<div>{html.escape(note[0].upper() + note[1:])}.</div>" for note in grid.notes())
        self._notes.object = f'<div class="quiet">{notes}</div>' if notes else ""
        write_query(**settings.to_query())
        if not self._held:
            missing = dict.fromkeys([*grid.unflown(), *(close.wanted if close else ())])
            self._join([work for work in missing if self._queue.state(work) in ("waiting", "flying")])
        self._fly_unasked(close)
        self._tell()

    def _fly_unasked(self, close: Closely | None) -> None:
        if new := self._unasked(close):
            self._want(new, soon=True)

    def _unasked(self, close: Closely | None) -> list[Work]:
        """What is looked at closely flies of its own accord, unless it is long, failed, or was cancelled."""
        wanted = [] if close is None or self._held else close.wanted
        return [work for work in wanted if work.episodes <= UNASKED and not self._queue.state(work)]

    def _tick(self) -> None:
        over = self._progress.ended()
        if not over and not self._progress.pending:
            return
        errors = {standing.error for work in over if (standing := self._queue.standing(work))}
        if errors:
            self._complain(" ".join(f"{error[0].upper()}{error[1:]}." for error in sorted(errors)))
        if over:
            pn.state.execute(self._refresh, schedule=True)
        self._tell()

    def _tell(self) -> None:
        grid = self._grid
        self._progress.show(grid.unflown() if grid else (), _sources(grid) if grid else "")

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)


def read_theme() -> str:
    """`theme` of this page's address, for addresses of others."""
    from urllib.parse import parse_qsl

    location = pn.state.location
    return dict(parse_qsl(location.search.removeprefix("?"))).get("theme", "") if location is not None else ""


def _sources(grid: Grid) -> str:
    """Where the figures come from, as HTML."""
    if not grid.cells:
        return "Choose at least one policy and one task."
    figures = [cell.figures for cell in grid.cells.values() if cell.figures is not None]
    shipped, flown = sum(one.shipped for one in figures), sum(not one.shipped for one in figures)
    words = []
    if flown:
        words.append(f"{flown} of {len(grid.cells)} flown here")
    if shipped:
        command = "<code>workbench reproduce fig13</code>"
        words.append(f"{shipped} from the result set that comes with the workbench ({command})")
    if missing := len(grid.cells) - len(figures):
        words.append(f"{missing} not flown yet")
    return f'<span class="quiet">{"; ".join(words)}.</span>' if words else ""
