"""The first page: two policies fly from the same initial state and are replayed side by side on one clock."""

from __future__ import annotations

import asyncio
import html
from dataclasses import replace
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.theme import POLICY_A, POLICY_B
from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from workbench.context import AppContext
from workbench.export_menu import ExportMenu
from workbench.flight_view import FlightView
from workbench.pages.address import read_query, write_query
from workbench.pages.fly_cards import CARD_CSS, flight_card, note_card
from workbench.pages.fly_clock import FlightClock
from workbench.pages.fly_controls import FlyControls
from workbench.pages.fly_cursors import FlightCursors
from workbench.pages.fly_events import EventList, event_rows
from workbench.pages.fly_figures import Pair
from workbench.pages.fly_flights import BlindPolicyError, Flights, fly_both
from workbench.pages.fly_help import HelpSheet
from workbench.pages.fly_hud import FlightHud
from workbench.pages.fly_layout import arrange
from workbench.pages.fly_look import READOUTS, frame_values, looked, read_look
from workbench.pages.fly_settings import FlySettings, default_settings, keep_start, read_settings
from workbench.pages.fly_stick import FlyStick
from workbench.pages.fly_stick_view import StickParts
from workbench.pages.fly_tabs import FlightTabs
from workbench.pages.one_change import one_change
from workbench.policies import policy_choices
from workbench.scenarios import scenario_choices

COLOURS = {"A": POLICY_A, "B": POLICY_B}
PATIENCE_S = 0.5
CORNER = {"margin": 0, "width": 30, "height": 30, "sizing_mode": "fixed"}
SLIM = {
    "py": 0, "alignItems": "center", "& p": {"margin": 0}, "& .MuiAlertTitle-root:empty": {"display": "none"},
    "& .MuiAlert-message": {"padding": "6px 0"},
}  # fmt: skip
"""A notice of one line, so that the replay stays in view."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Fly page of one session."""
    return FlyPage(context).layout


class FlyPage:
    """Controls, replay, clock, events and curves of one session, and what connects them."""

    def __init__(self, context: AppContext) -> None:
        self._context = context
        self._labels = {spec: label for label, spec in policy_choices(context.store).items()}
        scenarios = scenario_choices(context.store)
        defaults = default_settings(list(self._labels))
        self._settings, problems = read_settings(read_query(), self._labels, scenarios.values(), defaults)
        self._look, odd = read_look(read_query())
        problems += odd
        self._request = 0
        self._flown = False
        self._offered: frozenset[int] = frozenset()
        self._controls = FlyControls(self._settings, self._labels, scenarios, self._choose)
        self._make_views()
        self.layout = self._arrange()
        self._complain(" ".join(problems))
        pn.state.onload(self._fly)

    def _make_views(self) -> None:
        self._alert, self._note = (
            pmui.Alert(object="", severity=severity, visible=False, margin=0, sizing_mode="stretch_width", sx=SLIM)
            for severity in ("warning", "info")
        )
        self._offer = pmui.Button(
            label="", icon="visibility_off", variant="outlined", visible=False, margin=0, sizing_mode=None
        )
        self._offer.on_click(lambda _event: self._controls.mask(self._offered))
        self._progress = pmui.LinearProgress(
            variant="indeterminate", sizing_mode="stretch_width", margin=0, height=4, visible=True
        )
        self._cards = {
            letter: pn.pane.HTML(
                note_card(letter, self._labels[spec], COLOURS[letter], "flying …"),
                stylesheets=[CARD_CSS], margin=0, sizing_mode="stretch_width",
            )
            for letter, spec in (("A", self._settings.a), ("B", self._settings.b))
        }  # fmt: skip
        self._view = FlightView(self._context.viser, **frame_values(self._look))
        pn.state.on_session_destroyed(lambda _session: self._view.close())
        self._view.frame.param.watch(self._watch_frame, ["camera", "eye", "drawn", "overlay"])
        self._hud = FlightHud(visible_hud=READOUTS in self._look.drawn, sizing_mode="stretch_width", margin=0)
        self._clock = FlightClock(
            time=self._settings.time_s, speed=self._look.speed, sizing_mode="stretch_width", margin=0, height=48
        )
        self._clock.param.watch(self._tick, "time")
        self._clock.param.watch(self._settle, "settled")
        self._clock.param.watch(lambda event: self._see(speed=event.new), "speed")
        self._export = ExportMenu(margin=0, sizing_mode=None)
        self._events = EventList(sizing_mode="stretch_width", margin=0)
        self._tabs = FlightTabs(
            self._context.recordings, load_scenario(self._settings.scenario), self._rerun_state, self._look,
            lambda tab, over, whole: self._see(tab=tab, over=over, whole=whole),
        )  # fmt: skip
        parts = StickParts(self._view, self._clock, self._events, self._export, self._tabs)
        self._stick = FlyStick(parts, self._context.store, self._labels)

    def _arrange(self) -> pn.viewable.Viewable:
        return arrange(
            controls=self._controls.items,
            notices=[self._progress, self._alert, self._offer, self._note],
            cards=list(self._cards.values()),
            replay=self._view.frame,
            readouts=self._hud,
            clock=[
                self._clock,
                self._export,
                HelpSheet(**CORNER),
                FlightCursors(width=0, height=0, margin=0),
            ],
            events=self._events,
            stick=self._stick.layout,
            tabs=self._tabs.layout,
        )

    def _choose(self) -> None:
        chosen = keep_start(self._controls.settings(), self._settings)
        if chosen != replace(self._settings, time_s=0.0):
            self._settings = chosen
            self._complain("")
            pn.state.execute(self._fly, schedule=True)

    async def _fly(self) -> None:
        self._request = number = self._request + 1
        settings = self._settings
        flying = asyncio.ensure_future(asyncio.to_thread(fly_both, settings, self._context.store))
        try:
            # Most flights are there before anybody could read a sign that they are coming.
            await asyncio.wait({flying}, timeout=PATIENCE_S)
            self._progress.visible = not flying.done()
            flights = await flying
        except SubMasError as error:
            self._refuse(settings, error)
            return
        finally:
            if number == self._request:
                self._progress.visible = False
        if number == self._request:
            # Figures may only be changed while the session's document is locked, which it is in a scheduled call.
            pn.state.execute(partial(self._show, settings, flights), schedule=True)

    @one_change()
    def _show(self, settings: FlySettings, flown: Flights) -> None:
        titles = (f"A · {self._labels[settings.a]}", f"B · {self._labels[settings.b]}")
        pair = Pair(flown.a, flown.b, *titles, flown.guide_a, flown.guide_b)
        flights = {"A": flown.a, "B": flown.b}
        self._flown = True
        self._note.param.update(object=html.escape(" ".join(flown.notes)), visible=bool(flown.notes))
        for letter, spec in (("A", settings.a), ("B", settings.b)):
            self._cards[letter].object = flight_card(letter, self._labels[spec], flights[letter], COLOURS[letter])
        self._tabs.show(pair)
        rows = event_rows(flights, COLOURS)
        self._events.events = rows
        self._export.offer(flown.a, flown.b, settings.to_query(), self._context.store.root)
        self._hud.flights = flown.readouts
        start = min(self._settings.time_s, pair.duration_s)
        self._clock.param.update(duration=pair.duration_s, marks=rows)
        if start != self._clock.time:
            self._clock.move(start)
        self._stick.show(settings, flown, rows)
        self._write_address()
        self._view.load_when_painted([pair.a, pair.b], start)

    def _refuse(self, settings: FlySettings, error: SubMasError) -> None:
        sentence = str(error)
        self._complain(f"{sentence[0].upper()}{sentence[1:]}. Nothing new was flown.")
        if isinstance(error, BlindPolicyError):
            self._offered = error.masked
            words = ", ".join(str(missile) for missile in sorted(error.masked))
            self._offer.param.update(label=f"Mask {words} and fly", visible=True)
        if self._flown:
            return
        for letter, spec in (("A", settings.a), ("B", settings.b)):
            self._cards[letter].object = note_card(letter, self._labels[spec], COLOURS[letter], "not flown")

    def _rerun_state(self) -> dict[str, Any]:
        return {"start": self._clock.time, "theme": "dark" if self._view.frame.dark else "light"}

    def _tick(self, event: Any) -> None:
        self._view.show(event.new)
        self._stick.tick(event.new)
        self._clock.shown = event.new

    def _settle(self, event: Any) -> None:
        self._settings = replace(self._settings, time_s=round(event.new, 1))
        self._write_address()

    def _watch_frame(self, *_events: Any) -> None:
        self._see(**looked(self._view.frame))

    def _see(self, **changes: Any) -> None:
        """Somebody looks at it differently."""
        self._look = replace(self._look, **changes)
        self._hud.visible_hud = READOUTS in self._look.drawn
        self._write_address()

    def _write_address(self) -> None:
        write_query(**self._settings.to_query(), **self._look.to_query())

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)
        self._offer.visible = False
