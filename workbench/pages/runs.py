"""The Runs page: thousands of runs to search, group, compare, read about, tag, delete and bring back."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any
from urllib.parse import parse_qsl

import panel as pn
import panel_material_ui as pmui

from layouts.run_curves import RUN_INKS
from workbench.context import AppContext
from workbench.pages.address import read_query, write_query
from workbench.pages.runs_actions import RunsActions
from workbench.pages.runs_bar import RunsBar
from workbench.pages.runs_below import RunsBelow
from workbench.pages.runs_follow import Follower, look
from workbench.pages.runs_settings import EXPERT, read_settings
from workbench.pages.runs_table import TABLE_HEIGHT, RunsTable
from workbench.pages.runs_values import bar_values, table_values
from workbench.pages.runs_view import gather_list, gather_more
from workbench.run_folder import is_run_id
from workbench.run_index.record import RunRecord
from workbench.run_notes import RunNotes

SETTLED_S = 0.6
"""How long a view has to stand before it becomes an entry of the browser's history."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Runs page of one session."""
    made = RunsPage(context)
    # Scheduled, not awaited: Panel shows its spinner over everything until what it loads has returned.
    pn.state.onload(lambda: pn.state.execute(made.live))
    pn.state.on_session_destroyed(lambda _session: made.follower.stop())
    return made.layout


class RunsPage:
    """One session's view of the runs."""

    def __init__(self, context: AppContext) -> None:
        self._index = context.index
        self._store = context.store
        self.settings = self._opened = read_settings(read_query())
        self._ready = False
        self.follower = Follower(self.tick)
        # What the index has at hand is shown with the first paint; an index that has to be made is waited for later.
        self._listed = gather_list(self._index, self.settings) if self._index.is_open else None
        self._asked = self._marks = 0
        self._taking = False
        self._actions = RunsActions(self._store, self._index, self._moved)
        self.below: RunsBelow | None = None
        self._make_parts()
        self.layout = pn.Column(
            self._alert, self.bar, self.table, sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "12px"}
        )
        self._take()

    def _make_parts(self) -> None:
        self.bar = RunsBar(sizing_mode="stretch_width", margin=0)
        self.table = RunsTable(sizing_mode="stretch_width", height=TABLE_HEIGHT, margin=0, inks=list(RUN_INKS))
        self._alert = pmui.Alert(object="", visible=False, severity="info", margin=0, sizing_mode="stretch_width")
        for name in ("text", "chosen", "trash"):
            self.bar.param.watch(self._search, name)
        self.bar.param.watch(lambda event: self._change(group=event.new, opened=(), shown=self._single_runs()), "group")
        self.bar.param.watch(lambda event: self._act_on_ticked(event.new[0]), "asked")
        self.bar.param.watch(lambda event: self._arrive(event.new[0]), "visited")
        self.table.param.watch(self._search, "sort")
        self.table.param.watch(lambda event: self._change(run=event.new), "focused")
        self.table.param.watch(self._scroll, "first")
        self.table.param.watch(lambda event: self._mark(*event.new[:2]), "asked")

    def _furnish(self) -> None:
        """Add what stands below the table, once the table stands."""
        self.below = RunsBelow(self.settings, self._actions, self._change, self._act, self._write)
        self.layout.extend([self._actions.notice, *self.below.items])
        self._take()
        pn.state.execute(self._settle)

    # What a person changes.

    def _change(self, **changes: Any) -> None:
        if self._taking:
            return
        settings = replace(self.settings, **changes)
        if settings != self.settings:
            self.settings = settings
            pn.state.execute(self.refresh)

    def _search(self, _event: object = None) -> None:
        chosen = {name: tuple(values) for name, values in self.bar.chosen.items() if values}
        sort = self.table.sort or self.settings.search.sort
        search = replace(self.settings.search, text=self.bar.text, chosen=chosen, trashed=self.bar.trash, sort=sort)
        if not self._taking and search != self.settings.search:
            self.table.first = 0
        self._change(search=search)

    def _scroll(self, _event: object) -> None:
        if not self._taking:
            pn.state.execute(self._relist)

    def _mark(self, what: str, key: str) -> None:
        if what == "tick":
            settings = self.settings.toggled(key)
            self._change(shown=settings.shown)
        elif what == "fold":
            opened = self.settings.opened
            self._change(opened=tuple(each for each in opened if each != key) if key in opened else (*opened, key))

    def _single_runs(self) -> tuple[str, ...]:
        return tuple(key if is_run_id(key) else "" for key in self.settings.shown)

    def _act(self, what: str) -> None:
        """A button of the panel, for the run that is read about."""
        record = self._listed.record if self._listed else None
        if what == "pin" and record is not None:
            self._change(baseline=EXPERT if self.settings.baseline == record.id else record.id)
        elif record is not None:
            self._actions.ask(what, [record])

    def _act_on_ticked(self, what: str) -> None:
        """A button of the bar."""
        if what == "untick":
            self._change(shown=())
        else:
            self._actions.ask(what, self._ticked())

    def _ticked(self) -> list[RunRecord]:
        return [record for key in self.settings.shown_runs if (record := self._index.get(key))]

    def _write(self, notes: RunNotes) -> None:
        record = self._listed.record if self._listed else None
        if record is not None:
            pn.state.execute(partial(self._actions.write, record, notes))

    async def _moved(self, gone: Sequence[str]) -> None:
        self.settings = self.settings.without(gone)
        await asyncio.to_thread(self._index.look)
        await self.refresh()

    def _arrive(self, address: str) -> None:
        """The browser went back or forward."""
        settings = read_settings(dict(parse_qsl(address.removeprefix("?"))))
        if settings != self.settings:
            self.settings = settings
            pn.state.execute(partial(self.refresh, written=True))

    # What it shows.

    async def live(self) -> None:
        """Start, and follow the folders until the page is left."""
        await self.start()
        self.follower.start()

    async def start(self) -> None:
        """Show the list of the address, then everything else."""
        self._ready = True
        await self._relist()
        pn.state.execute(self._furnish, schedule=True)

    async def _settle(self) -> None:
        """Draw what the view shows, then bring the index up to date."""
        await self.refresh(written=self.settings == self._opened)
        await self.tick()

    async def tick(self) -> None:
        """Follow the folders."""
        changed = await look(self._index, self._relist)
        if changed or self._listed is None or self._listed.version != self._index.version:
            await self.refresh(written=True)

    async def refresh(self, written: bool = False) -> None:
        """Show the settings as they are; `written` says that the address has them already.

        What changes before the page stands in the browser is shown when it does: Panel loses what is sent earlier.
        """
        if not self._ready:
            return
        await self._relist()
        if not written:
            pn.state.execute(self._write_address)
        await self._remore()

    async def _relist(self) -> None:
        if not self._ready:
            return
        self._asked += 1
        asked, settings = self._asked, self.settings
        listed = await asyncio.to_thread(gather_list, self._index, settings, self.table.first)
        if asked == self._asked:
            self._listed = listed
            pn.state.execute(self._take, schedule=True)

    async def _remore(self) -> None:
        self._marks += 1
        mark, settings, listed = self._marks, self.settings, self._listed
        if listed is None or self.below is None:
            return
        more = await asyncio.to_thread(gather_more, self._index, settings, listed.listing)
        if mark == self._marks:
            # Figures may only be changed while the session's document is locked, which it is in a scheduled call.
            pn.state.execute(partial(self.below.show, settings, more), schedule=True)

    async def _write_address(self) -> None:
        settings = self.settings
        await asyncio.sleep(SETTLED_S)
        if settings == self.settings:
            write_query(**settings.to_query())

    def _take(self) -> None:
        """Everything that follows from the settings and the list, in one go."""
        settings, listed = self.settings, self._listed
        self._taking = True
        try:
            self.bar.param.update(**bar_values(settings, listed, self._index.reading))
            self.table.param.update(**table_values(settings, listed))
            self._alert.param.update(object=html.escape(self._index.notice), visible=bool(self._index.notice))
            if self.below is not None:
                self.below.take(settings, listed)
        finally:
            self._taking = False
