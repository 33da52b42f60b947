"""The tabs below the replay: curves of both flights, and Rerun, which is opened when it is first looked at."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.models import Title
from bokeh.plotting import figure

from sim.scenario import Scenario
from sim.trajectory import Trajectory
from workbench.pages.fly_figures import ChartPairs, Pair, Sight
from workbench.pages.fly_look import TABS, FlyLook
from workbench.recordings import Recordings

# Here, not where it is made: a browser is told of a component's kind with the page, or never.
from workbench.rerun_pane import RerunPane

RERUN = "Rerun"
RERUN_HEIGHT = 620
TABS_SX = {"& .MuiTab-root": {"minWidth": 0, "padding": "10px 13px"}}
SWITCH_SX = {
    "& .MuiToggleButton-root": {
        "padding": "2px 9px",
        "fontSize": "12px",
        "textTransform": "none",
        "whiteSpace": "nowrap",
    }
}
SWITCH_CSS = """
.switches { position: absolute !important; right: 0; top: 8px; z-index: 2; gap: 10px; width: auto !important }
@media (max-width: 1180px) { .switches { position: static !important; margin-left: auto !important } }
"""


class FlightTabs:
    """Shows what belongs to the pair of flights it was last given."""

    def __init__(
        self, recordings: Recordings, scenario: Scenario, state: Callable[[], dict[str, Any]],
        look: FlyLook | None = None, looked: Callable[[str, bool, bool], None] = lambda *_choice: None,
    ) -> None:  # fmt: skip
        """Make the tabs; `looked` hears of the tab, of `over` and of `whole` when a person chooses them."""
        look = look or FlyLook()
        self._recordings, self._state, self._looked = recordings, state, looked
        self._pair: Pair | None = None
        self._branch: tuple[str, Trajectory] | None = None
        self._recorded: dict[str, Trajectory] = {}
        self._shown: dict[str, tuple[Pair, Sight]] = {}
        self._drawn: dict[str, bool] = {}
        self._scenario, self._charts = scenario, ChartPairs(scenario)
        self._bodies = {title: pn.Column(sizing_mode="stretch_width", margin=0) for title in ChartPairs.tabs}
        self._rerun = pmui.Column(sizing_mode="stretch_width", margin=0, min_height=RERUN_HEIGHT)
        self._over = _switch({"Side by side": False, "Overlaid": True}, look.over)
        self._whole = _switch({"Missiles in flight": False, "Whole flight": True}, look.whole)
        tabs = [*self._bodies.items(), (RERUN, self._rerun)]
        active = TABS.index(look.tab)
        self._tabs = pmui.Tabs(*tabs, active=active, dynamic=True, sizing_mode="stretch_width", margin=0, sx=TABS_SX)
        if active < len(self._bodies):
            self._draw(list(self._bodies)[active])
        for widget, name in ((self._tabs, "active"), (self._over, "value"), (self._whole, "value")):
            widget.param.watch(self._look, name)
        switches = pmui.Row(self._whole, self._over, margin=0, width=None, sizing_mode=None, css_classes=["switches"])
        self.layout = pn.Column(
            switches, self._tabs, sizing_mode="stretch_width", margin=0, styles={"position": "relative"},
            stylesheets=[SWITCH_CSS],
        )  # fmt: skip

    def show(self, pair: Pair) -> None:
        """New flights: the open tab changes at once, the others when they are opened; another scenario has others."""
        self._pair, self._branch = pair, None
        if pair.a.task.scenario != self._scenario:
            self._start_anew(pair.a.task.scenario)
        self._charts.fit_time(pair, self._sight)
        self._open()

    def show_branch(self, branch: Trajectory | None, title: str = "") -> None:
        """Rerun shows a branch beside both flights; the curves of a branch are elsewhere. None: without one."""
        self._branch = None if branch is None else (title, branch)
        if self._title == RERUN:
            self._open()

    @property
    def _sight(self) -> Sight:
        return Sight(over=bool(self._over.value), whole=bool(self._whole.value))

    @property
    def _title(self) -> str:
        return [*self._bodies, RERUN][self._tabs.active]

    def _start_anew(self, scenario: Scenario) -> None:
        """Forget the figures: other missiles, another battlefield."""
        self._scenario, self._charts = scenario, ChartPairs(scenario)
        self._shown.clear()
        self._drawn.clear()
        for body in self._bodies.values():
            body.objects = []

    def _look(self, event: Any) -> None:
        sight = self._sight
        if event.obj is self._whole and self._pair is not None:
            self._charts.fit_time(self._pair, sight)
        self._open()
        self._looked(TABS[self._tabs.active], sight.over, sight.whole)

    def _open(self) -> None:
        title = self._title
        if self._pair is None:
            return
        if title == RERUN:
            self._record()
            return
        shown = (self._pair, replace(self._sight, whole=False))
        if self._shown.get(title) == shown:
            return
        self._shown[title] = shown
        for kind in ChartPairs.tabs[title]:
            self._charts.pair(kind).show(self._pair, self._sight.over)
        self._draw(title)

    def _draw(self, title: str) -> None:
        """Put the figures of a tab into it, unless they are there."""
        over = self._sight.over
        if self._drawn.get(title) != over:
            self._drawn[title] = over
            rows = [self._charts.pair(kind).figures(over) for kind in ChartPairs.tabs[title]]
            for figures in rows[1:]:
                _untitled(figures)
            self._bodies[title].objects = [_row(figures) for figures in rows]

    def _record(self) -> None:
        """Have Rerun show the flights, unless it does."""
        pair = self._pair
        if pair is None:
            return
        flights = {pair.title_a: pair.a, pair.title_b: pair.b, **dict([self._branch] if self._branch else [])}
        if [*map(id, flights.values())] != [*map(id, self._recorded.values())]:
            self._recorded = flights
            pn.state.execute(self._open_rerun, schedule=True)

    async def _open_rerun(self) -> None:
        flights = self._recorded
        address = f"/rrd/{await asyncio.to_thread(self._recordings.compare, flights)}"
        if flights is not self._recorded:
            return
        if self._rerun.objects:
            self._rerun.objects[0].recording = address
        else:
            pane = RerunPane(
                recording=address, **self._state(), height=RERUN_HEIGHT, sizing_mode="stretch_width", margin=0
            )
            self._rerun.objects = [pane]


def _untitled(figures: list[figure]) -> None:
    """Figures below others need not say again whose they are."""
    for fig in figures:
        if isinstance(fig.title, Title):
            fig.title.visible = False


def _row(figures: list[figure]) -> pn.viewable.Viewable:
    return pn.Row(
        *(
            pn.pane.Bokeh(fig, sizing_mode="stretch_width", margin=(0, 12 * (fig is not figures[-1]), 0, 0))
            for fig in figures
        ),
        sizing_mode="stretch_width",
        margin=0,
    )


def _switch(options: dict[str, bool], value: bool) -> pmui.RadioButtonGroup:
    return pmui.RadioButtonGroup(
        options=options, value=value, size="small", margin=0, sizing_mode=None, color="primary", sx=SWITCH_SX
    )
