"""Take the stick: from any moment of a flight another policy, or the person, flies on; one branch at a time."""

from __future__ import annotations

import asyncio
import html
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import panel as pn

from agents.policy import bind
from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.trajectory import Trajectory
from workbench.branch import Branch, fly_branch
from workbench.branch_stick import Stick
from workbench.branch_text import branch_text, read_branch
from workbench.pages.address import read_query, write_query
from workbench.pages.fly_flights import RECORD_EVERY, Flights
from workbench.pages.fly_settings import FlySettings
from workbench.pages.fly_start import start_of
from workbench.pages.fly_stick_dial import dial_sight, whole_heading
from workbench.pages.fly_stick_live import LiveFlight
from workbench.pages.fly_stick_view import BranchView, StickParts
from workbench.pages.fly_stick_widgets import StickWidgets
from workbench.policies import resolve_policy
from workbench.runs import RunStore

TICK_MS = 80
ROOM_S = 120.0
"""The clock of a flight by hand is longer than what was flown by so much at most [s]."""
KEEP_S = 5.0
"""Wall time between two notes in the address of what was flown by hand [s]."""


class FlyStick:
    """The one branch of a page session; `show` after every pair of flights, `tick` with the clock."""

    def __init__(self, parts: StickParts, store: RunStore, labels: Mapping[str, str]) -> None:
        self._clock, self._store, self._labels = parts.clock, store, labels
        self._wanted = read_query().get("branch", "")
        self._settings: FlySettings | None = None
        self._flights: dict[str, Trajectory] = {}
        self._request = 0
        self._branch: Branch | None = None
        self._live: LiveFlight | None = None
        self._ticker: Any = None
        self._ticked = self._kept = 0.0
        self.widgets = StickWidgets(labels)
        self._view = BranchView(parts, self.widgets, labels)
        self._connect()
        self.layout = self.widgets.layout

    def show(self, settings: FlySettings, flown: Flights, rows: Sequence[dict[str, Any]]) -> None:
        """New flights: the branch of the old ones is gone; that of the address is flown once.

        Args:
            settings: what the page shows.
            flown: its flights.
            rows: the events of its list.
        """
        self._settings, self._flights = settings, {"A": flown.a, "B": flown.b}
        self._view.begin(self._flights, rows)
        self._offer_other()
        wanted, self._wanted = self._wanted, ""
        if not wanted:
            self.remove()
            return
        try:
            branch = read_branch(wanted, self._labels, flown.a.task.scenario.rules.max_steps)
        except SubMasError as error:
            self._refuse(error)
            return
        self.widgets.of.value = branch.of
        self._fly(branch)

    def tick(self, time_s: float) -> None:
        """The clock moved to this time [s]."""
        if self._live is None and self._flights:
            self.widgets.tell(self._step(time_s) >= len(self._original.action_rad))

    def remove(self) -> None:
        """Back to the original: stop flying by hand, forget the branch."""
        self._request += 1
        self._stop()
        self._branch = None
        self._view.nothing()
        self._complain("")
        write_query(branch="")
        self.tick(self._clock.time)

    def _connect(self) -> None:
        parts = self.widgets
        parts.of.param.watch(lambda _event: self._offer_other(), "value")
        parts.take.on_click(lambda _event: self._fly(self._from_here(parts.who.value)))
        parts.steer.on_click(lambda _event: self._steer(self._from_here(self._original.policy)))
        parts.hand_over.on_click(lambda _event: self._hand_over())
        for button in (parts.cancel, parts.back):
            button.on_click(lambda _event: self.remove())
        parts.steer_on.on_click(lambda _event: self._steer_on())
        parts.dial.param.watch(lambda _event: self._keep(), "running")

    @property
    def _original(self) -> Trajectory:
        return self._flights[self.widgets.of.value]

    def _step(self, time_s: float) -> int:
        return int(time_s / self._original.task.scenario.rules.step_s + 1e-6)

    def _offer_other(self) -> None:
        """The other flight's policy is who most people want to see fly on."""
        if self._settings is None:
            return
        policies = {"A": self._settings.a, "B": self._settings.b}
        own = policies.pop(self.widgets.of.value)
        if self.widgets.who.value in (None, own, self.widgets.first):
            self.widgets.who.value = next(iter(policies.values()))
        self.tick(self._clock.time)

    def _from_here(self, policy: str) -> Branch:
        """The branch at the clock's present moment in which this policy flies on."""
        return Branch(self.widgets.of.value, self._step(self._clock.time), (), policy)

    def _fly(self, branch: Branch, remark: str = "") -> None:
        """Fly a branch to its end, aside; it is shown when it is there, with a remark if there is one to make."""
        self._request += 1
        self._stop()
        self._complain(remark)
        self.widgets.show(live=False, branch=self._branch is not None)
        self.widgets.take.loading = True
        pn.state.execute(partial(self._fly_on, branch, self._request), schedule=True)

    async def _fly_on(self, branch: Branch, request: int) -> None:
        try:
            flight = await asyncio.to_thread(self._flown, branch)
        except SubMasError as error:
            if request == self._request:
                pn.state.execute(partial(self._refuse, error, branch), schedule=True)
            return
        if request == self._request:
            pn.state.execute(partial(self._show_branch, branch, flight), schedule=True)

    def _flown(self, branch: Branch) -> Trajectory:
        original = self._flights[branch.of]
        act = bind(resolve_policy(branch.policy, self._store), original.task) if branch.policy else None
        return fly_branch(original, branch, act, RECORD_EVERY, self._state())

    def _state(self) -> Any:
        """The initial state of the flights, None for that of their episode."""
        assert self._settings is not None
        task = Task(load_scenario(self._settings.scenario), self._settings.masked)
        return start_of(task, self._settings)[1]

    def _show_branch(self, branch: Branch, flight: Trajectory) -> None:
        self._branch = branch
        self.widgets.take.loading = False
        self._view.flown(branch, flight)
        write_query(branch=branch_text(branch))
        self.tick(self._clock.time)

    def _steer(self, branch: Branch) -> None:
        """Give the person the stick at the end of the branch's headings."""
        self._request += 1
        try:
            stick = Stick(self._flights[branch.of], branch, self._state())
        except SubMasError as error:
            self._refuse(error)
            return
        self._stop()
        self._complain("")
        self._live, self._branch = LiveFlight(stick), None
        sight = stick.sight()
        self.widgets.heir.value = branch.policy
        self.widgets.dial.param.update(running=False, sight=dial_sight(sight))
        self.widgets.dial.ask(whole_heading(sight.heading_rad))
        self._view.flying(branch.of, stick)
        self._ticked = self._kept = time.monotonic()
        self._ticker = pn.state.add_periodic_callback(self._go_on, TICK_MS)

    def _go_on(self) -> None:
        """One beat of a flight by hand."""
        now = time.monotonic()
        passed_s, self._ticked = now - self._ticked, now
        live, dial = self._live, self.widgets.dial
        if live is None or not dial.running:
            return
        live.advance(passed_s, dial.speed, dial.heading)
        if live.time_s > self._clock.duration:
            self._clock.duration = live.time_s + ROOM_S
        self._clock.move(round(live.time_s, 2))
        dial.sight = dial_sight(live.stick.sight())
        if live.over:
            self._hand_over()
        elif now - self._kept > KEEP_S:
            self._keep()

    def _keep(self) -> None:
        """Note in the address what was flown by hand so far: a reload flies it again."""
        self._kept = time.monotonic()
        if self._live is not None and self._live.stick.headings_deg:
            write_query(branch=branch_text(self._live.stick.flown(self.widgets.heir.value)))

    def _hand_over(self) -> None:
        if self._live is None:
            return
        stick, heir = self._live.stick, self.widgets.heir.value
        if not stick.headings_deg and not heir:
            stick.step(self.widgets.dial.heading)
        self._fly(stick.flown("" if stick.over else heir))

    def _steer_on(self) -> None:
        branch = self._branch
        if branch is None or not branch.by_hand:
            return
        flown = self._step(self._clock.time) - branch.step
        kept = branch.headings_deg[:flown] if 0 < flown < len(branch.headings_deg) else branch.headings_deg
        self._steer(replace(branch, headings_deg=kept))

    def _stop(self) -> None:
        if self._ticker is not None:
            self._ticker.stop()
        self._ticker = self._live = None

    def _refuse(self, error: SubMasError, branch: Branch | None = None) -> None:
        sentence = f"{str(error)[0].upper()}{str(error)[1:]}."
        if branch is not None and branch.by_hand and branch.policy:
            # What a person flew is not lost because nobody can take over.
            self._fly(replace(branch, policy=""), f"{sentence} The last heading is held instead.")
            return
        self.remove()
        self._complain(f"{sentence} No branch is flown.")

    def _complain(self, sentence: str) -> None:
        self.widgets.take.loading = False
        self.widgets.problem.param.update(object=html.escape(sentence), visible=bool(sentence))
