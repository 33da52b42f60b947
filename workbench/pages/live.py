"""The Live page: trainings as they learn: stages, curves, events, what can be done, and the news of their end."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any
from urllib.parse import parse_qsl

import panel as pn
import panel_material_ui as pmui

from sim.errors import SubMasError
from workbench.context import AppContext
from workbench.launcher import resume, stop_now
from workbench.pages.address import read_query, write_query
from workbench.pages.live_cards import EVENTS_CSS
from workbench.pages.live_chain import LiveChain
from workbench.pages.live_curves import LiveCurves
from workbench.pages.live_desk import LiveDesk, LiveLook, LiveRun
from workbench.pages.live_head import LiveHead
from workbench.pages.live_layout import LiveLayout, nothing
from workbench.pages.live_list import LiveList
from workbench.pages.live_settings import MOST_BESIDE, LiveSettings, read_settings
from workbench.pages.live_view import LiveView
from workbench.pages.runs_follow import Follower
from workbench.runs import Run, RunStore

SETTLED_S = 0.4
"""How long a view has to stand before it becomes an entry of the browser's history."""

ACTS: dict[str, Callable[[RunStore, Run], object]] = {
    "pause": lambda _store, run: run.request_pause(),
    "stop": lambda _store, run: run.request_stop(),
    "resume": resume,
    "kill": lambda _store, run: stop_now(run),
}
"""What a button of the head does with the opened run."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Live page of one session."""
    made = LivePage(context)
    # Scheduled, not awaited: Panel shows its spinner over everything until what it loads has returned.
    pn.state.onload(lambda: pn.state.execute(made.live))
    pn.state.on_session_destroyed(lambda _session: made.follower.stop())
    return made.layout


class LivePage:
    """One session's view of the trainings."""

    def __init__(self, context: AppContext) -> None:
        self._store = context.store
        self._desk = LiveDesk(context)
        self.settings = read_settings(read_query())
        self.follower = Follower(self.refresh)
        self._turn = asyncio.Lock()
        self._taking = False
        self._make_parts()
        self._places = LiveLayout(self)
        self.layout = self._places.layout
        self._take_settings()
        self._opened, self._standing = self.settings, False
        self._wanted: tuple[LiveSettings, bool] | None = None
        # What the index has at hand is shown with the first paint.
        if context.index.is_open:
            self._show(self._desk.look(self.settings, follow=False))

    def _make_parts(self) -> None:
        wide: dict[str, Any] = {"sizing_mode": "stretch_width", "margin": 0}
        self.head, self.chain = LiveHead(**wide), LiveChain(**wide)
        self.list, self.view = LiveList(**wide), LiveView(**wide)
        self.curves = LiveCurves(self._hide)
        self.events = pn.pane.HTML("", stylesheets=[EVENTS_CSS], **wide)
        self.empty = pn.pane.HTML("", **wide)
        self.alert = pmui.Alert(object="", visible=False, severity="warning", **wide)
        self.head.param.watch(lambda event: pn.state.execute(partial(self.act, event.new[0])), "asked")
        self.list.param.watch(lambda event: self._ask(*event.new[:2]), "asked")
        self.view.param.watch(lambda event: self._change(x=event.new), "x")
        self.view.param.watch(lambda event: self._change(smooth=event.new), "smooth")
        self.view.param.watch(lambda event: self._change(without=tuple(event.new)), "without")
        self.view.param.watch(lambda event: self._arrive(event.new[0]), "visited")

    # What a person changes.

    def _change(self, **changes: Any) -> None:
        if not self._taking:
            self._open(replace(self.settings, **changes))

    def _open(self, settings: LiveSettings, written: bool = False) -> None:
        if not self._standing:
            # What is sent before the browser has built the page is lost: it waits until then.
            self._wanted = (settings, written)
            return
        if settings == self.settings:
            return
        self.settings = settings
        self._take_settings()
        pn.state.execute(self.refresh)
        if not written:
            pn.state.execute(self._write_address)

    def _hide(self, name: str) -> None:
        hidden = self.settings.hidden
        others = tuple(each for each in hidden if each != name)
        self._change(hidden=others if name in hidden else (*hidden, name))

    def _ask(self, what: str, run_id: str) -> None:
        """A click in the list."""
        if what == "open":
            self._open(self.settings.opening(run_id))
        elif what == "beside":
            self._open(self.settings.toggled(run_id))
        elif what == "alone":
            self._change(beside=())
        elif what == "seeds":
            pn.state.execute(self._lay_seeds)

    async def _lay_seeds(self) -> None:
        found = await asyncio.to_thread(self._desk.seeds, self.settings)
        self._change(beside=tuple(found[:MOST_BESIDE]))

    def _arrive(self, address: str) -> None:
        """The browser went back or forward."""
        self._open(read_settings(dict(parse_qsl(address.removeprefix("?")))), written=True)

    async def act(self, what: str) -> None:
        """A button of the head, for the opened run."""
        act = ACTS.get(what)
        if act is None:
            return
        try:
            await asyncio.to_thread(lambda: act(self._store, self._store.get(self.settings.run)))
        except SubMasError as error:
            if pn.state.notifications is not None:
                pn.state.notifications.error(html.escape(str(error)), duration=8000)
        await self.refresh()

    # What it shows.

    async def live(self) -> None:
        """Show what there is, and follow it until the page is left."""
        self._standing = True
        if self._wanted is not None:
            self._open(*self._wanted)
        await self.refresh()
        self.follower.start()
        if self.settings != self._opened:
            await self._write_address()

    async def refresh(self) -> None:
        """Show what has changed since the last look."""
        async with self._turn:
            settings = self.settings
            found = await asyncio.to_thread(self._desk.look, settings)
        if settings == self.settings:
            # Figures may only be changed while the session's document is locked, which it is in a scheduled call.
            pn.state.execute(partial(self._show, found), schedule=True)

    def _show(self, found: LiveLook) -> None:
        if self.settings != found.settings:
            self.settings = found.settings
            if self._standing:
                pn.state.execute(self._write_address)
        if found.sides is not None:
            self.list.lines, self.head.watched = found.sides.lines, found.sides.watched
        shown = bool(found.settings.run) and not found.problem
        if not shown:
            self._show_nothing(found)
        elif found.run is not None:
            self._show_run(found.run)
        self._places.stand(shown, bool(found.settings.run))

    def _show_run(self, run: LiveRun) -> None:
        self.head.facts, self.chain.cards = run.facts, run.chain
        if self.events.object != run.events:
            self.events.object = run.events
        self.curves.show(self.settings, run.drawing)
        self._complain(f"Not all of this run can be shown: {run.problem}." if run.problem else "")

    def _show_nothing(self, found: LiveLook) -> None:
        self.head.facts = "{}"
        self.empty.object = nothing(found.finished)
        self._complain(f"{found.problem}." if found.problem else "")

    def _take_settings(self) -> None:
        self._taking = True
        try:
            settings = self.settings
            self.view.param.update(x=settings.x, smooth=settings.smooth, without=list(settings.without))
            self.curves.take(settings)
        finally:
            self._taking = False

    async def _write_address(self) -> None:
        settings = self.settings
        await asyncio.sleep(SETTLED_S)
        if settings == self.settings:
            write_query(**settings.to_query())

    def _complain(self, sentence: str) -> None:
        self.alert.param.update(object=html.escape(sentence), visible=bool(sentence))
