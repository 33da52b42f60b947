"""Where a branch is seen: the 3-D replay, the events, the clock's rail, its card and its curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import panel as pn

from layouts.branch_chart import BranchCharts
from layouts.captions import clock_text
from layouts.letters import branch_letter
from layouts.theme import BRANCH, POLICY_A, POLICY_B
from sim.trajectory import Trajectory
from workbench.branch import Branch, moment_s
from workbench.branch_layer import BranchLayer
from workbench.branch_stick import Stick
from workbench.branch_text import FLIGHTS
from workbench.export_menu import ExportMenu
from workbench.flight_view import CHASE_LAYER, FlightView
from workbench.pages.fly_clock import FlightClock
from workbench.pages.fly_events import EventList, event_rows
from workbench.pages.fly_stick_card import branch_card
from workbench.pages.fly_stick_widgets import StickWidgets
from workbench.pages.fly_tabs import FlightTabs

INKS = {"A": POLICY_A, "B": POLICY_B}


@dataclass(frozen=True)
class StickParts:
    """Parts of the page that a branch shows itself in."""

    view: FlightView
    clock: FlightClock
    events: EventList
    export: ExportMenu
    tabs: FlightTabs


class BranchView:
    """Shows nothing, a flight that is being flown by hand, or a branch that is over."""

    def __init__(self, parts: StickParts, widgets: StickWidgets, labels: Mapping[str, str]) -> None:
        self._parts, self._widgets, self._labels = parts, widgets, labels
        self._flights: Mapping[str, Trajectory] = {}
        self._rows: Sequence[dict[str, Any]] = ()
        self._camera = ""
        self._layer = parts.view.layer = BranchLayer()
        self._charts: BranchCharts | None = None

    def begin(self, flights: Mapping[str, Trajectory], rows: Sequence[dict[str, Any]]) -> None:
        """Take the flights of the page, by letter, and the rows of its list of events."""
        self._flights, self._rows = flights, rows

    def nothing(self) -> None:
        """Show the flights of the page alone."""
        self._layer.nothing()
        self._parts.view.draw_layer()
        self._follow(False)
        self._widgets.show(live=False, branch=False)
        self._list_events({})
        self._hand_on(None)

    def flying(self, of: str, stick: Stick) -> None:
        """Show a flight by hand, seen from behind."""
        self._layer.flying(stick, self._flights[of].task.scenario.battlefield, FLIGHTS.index(of))
        self._parts.view.draw_layer()
        self._follow(True, look=True)
        self._list_events({})
        self._hand_on(None)
        self._widgets.show(live=True, branch=False)

    def flown(self, branch: Branch, flight: Trajectory) -> None:
        """Show a branch beside its original."""
        original = self._flights[branch.of]
        from_s = moment_s(original, branch)
        self._widgets.card.object = branch_card(branch.of, original, flight, self._who(branch, original))
        self._layer.flown(flight, from_s, FLIGHTS.index(branch.of))
        self._parts.view.draw_layer()
        self._follow(True)
        self._list_events({branch_letter(branch.of): flight}, from_s)
        self._hand_on(flight, f"{branch_letter(branch.of)} · {self._who(branch, original)}")
        self._draw_charts(original, flight, branch, from_s)
        self._widgets.steer_on.visible = branch.by_hand
        self._widgets.show(live=False, branch=True)

    def _hand_on(self, flight: Trajectory | None, title: str = "") -> None:
        """To the files and to Rerun; not while it is being flown."""
        if self._flights:
            self._parts.export.offer_branch(flight)
        self._parts.tabs.show_branch(flight, title)

    def _who(self, branch: Branch, original: Trajectory) -> str:
        step_s = original.task.scenario.rules.step_s
        words = [f"from {clock_text(branch.step * step_s)}"]
        if branch.by_hand:
            words.append(f"by hand, from {clock_text(branch.hand_ends * step_s)}")
        return " ".join([*words, self._labels.get(branch.policy, "") or "the last heading held"])

    def _draw_charts(self, original: Trajectory, flight: Trajectory, branch: Branch, from_s: float) -> None:
        charts = self._charts
        if charts is None or charts.scenario != original.task.scenario:
            charts = BranchCharts(original.task.scenario)
        charts.show(original, flight, from_s, branch.of, INKS[branch.of])
        if charts is not self._charts:
            # Only now that they are filled: changes could reach the browser before figures it does not know yet.
            self._charts = charts
            self._widgets.charts.objects = [
                pn.pane.Bokeh(figure, margin=0, sizing_mode="stretch_width") for figure in charts.figures
            ]

    def _list_events(self, branch: dict[str, Trajectory], from_s: float = 0.0) -> None:
        """The page's events and, after its moment, those of the branch; the clock ends with the longest flight."""
        rows = event_rows(branch, dict.fromkeys(branch, BRANCH))
        own = [row for row in rows if row["time"] > from_s or row["kind"] == "branch"]
        rows = sorted([*self._rows, *own], key=lambda row: (row["time"], row["who"]))
        self._parts.events.events = rows
        duration = max(flight.duration_s for flight in (*self._flights.values(), *branch.values()))
        # The clock knows two sides: the marks of a branch are on that of its original.
        self._parts.clock.param.update(duration=duration, marks=[{**row, "who": row["who"][0]} for row in rows])

    def _follow(self, branch: bool, look: bool = False) -> None:
        """Offer the camera that follows the branch; while somebody steers, look through it."""
        frame = self._parts.view.frame
        frame.branch = branch
        if look and frame.camera != CHASE_LAYER:
            self._camera, frame.camera = frame.camera, CHASE_LAYER
        elif not look and frame.camera == CHASE_LAYER:
            frame.camera = self._camera or "overview"
