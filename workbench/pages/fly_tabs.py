"""The tabs below the replay: curves of both flights, and Rerun, which is opened when it is first looked at."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from sim.scenario import Scenario
from workbench.pages.fly_figures import ChartPair, ChartPairs, Pair
from workbench.recordings import Recordings

RERUN = "Rerun"
RERUN_HEIGHT = 620


class FlightTabs:
    """Shows what belongs to the pair of flights it was last given."""

    def __init__(self, recordings: Recordings, scenario: Scenario, state: Callable[[], dict[str, Any]]) -> None:
        self._recordings, self._state = recordings, state
        self._pair: Pair | None = None
        self._recorded: Pair | None = None
        self._scenario, self._charts = scenario, ChartPairs(scenario)
        self._bodies = {title: pn.Row(sizing_mode="stretch_width", margin=0) for title in ChartPairs.titles}
        self._bodies["Azimuth"].objects = _panes(self._charts.pair("Azimuth"))
        self._rerun = pmui.Column(sizing_mode="stretch_width", margin=0, min_height=RERUN_HEIGHT)
        tabs = [*self._bodies.items(), (RERUN, self._rerun)]
        self.layout = pmui.Tabs(*tabs, dynamic=True, sizing_mode="stretch_width", margin=0)
        self.layout.param.watch(self._open, "active")

    def show(self, pair: Pair) -> None:
        """New flights: all curves change at once, Rerun only if it is open; another scenario has other curves."""
        self._pair = pair
        if pair.a.task.scenario != self._scenario:
            self._start_anew(pair.a.task.scenario)
        for charts in self._charts.made.values():
            charts.show(pair)
        self._open()

    def _start_anew(self, scenario: Scenario) -> None:
        """Forget the figures: other missiles, another battlefield."""
        self._scenario, self._charts = scenario, ChartPairs(scenario)
        for body in self._bodies.values():
            body.objects = []

    def _open(self, _event: object = None) -> None:
        title = [*self._bodies, RERUN][self.layout.active]
        if self._pair is None:
            return
        if title == RERUN and self._pair is not self._recorded:
            self._recorded = self._pair
            pn.state.execute(self._open_rerun, schedule=True)
        elif title != RERUN and title not in self._charts.made:
            charts = self._charts.pair(title)
            charts.show(self._pair)
            self._bodies[title].objects = _panes(charts)

    async def _open_rerun(self) -> None:
        from workbench.rerun_pane import RerunPane

        pair = self._recorded
        if pair is None:
            return
        flights = {pair.title_a: pair.a, pair.title_b: pair.b}
        address = f"/rrd/{await asyncio.to_thread(self._recordings.compare, flights)}"
        if pair is not self._recorded:
            return
        if self._rerun.objects:
            self._rerun.objects[0].recording = address
        else:
            pane = RerunPane(
                recording=address, **self._state(), height=RERUN_HEIGHT, sizing_mode="stretch_width", margin=0
            )
            self._rerun.objects = [pane]


def _panes(charts: ChartPair) -> list[pn.viewable.Viewable]:
    return [
        pn.pane.Bokeh(chart.figure, sizing_mode="stretch_width", margin=(0, 12 * (chart is charts.a), 0, 0))
        for chart in (charts.a, charts.b)
    ]
