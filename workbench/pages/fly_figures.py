"""The curves of both flights, side by side on common scales, changed in place when other flights are shown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from layouts.azimuth import azimuth_chart
from layouts.chart import CURSOR_TAG, FlightChart
from layouts.closure import closure_chart
from layouts.controls import ActionChart, GuideTrace, action_chart, bank_chart, load_chart
from layouts.energy import energy_chart
from layouts.map2d import map_chart, map_ranges
from layouts.overlay import OverlaidChart, overlay
from layouts.ranges import range_chart
from layouts.rewards import reward_chart
from layouts.speeds import speed_chart
from layouts.theme import POLICY_A, POLICY_B
from sim.scenario import Scenario
from sim.trajectory import Trajectory

HEIGHT, HALF_HEIGHT, LOW_HEIGHT = 245, 210, 165
MAP_HEIGHT = 380
LEAD_S = 15.0
ROOM = 0.05
"""Share of a scale left free beyond the outermost values."""


@dataclass(frozen=True)
class Pair:
    """The two flights of the page with their captions."""

    a: Trajectory
    b: Trajectory
    title_a: str
    title_b: str
    guide_a: GuideTrace | None = None
    guide_b: GuideTrace | None = None

    @property
    def columns(self) -> tuple[tuple[Trajectory, ...], tuple[str, ...], tuple[GuideTrace | None, ...]]:
        """Flights, captions and guides."""
        return (self.a, self.b), (self.title_a, self.title_b), (self.guide_a, self.guide_b)

    @property
    def duration_s(self) -> float:
        """Length of the longer flight."""
        return max(self.a.duration_s, self.b.duration_s)

    @property
    def engagement_s(self) -> tuple[float, float]:
        """From shortly before the first launch of either flight to shortly after its last missile has ended."""
        flown = [(m, f) for f in (self.a, self.b) for m in f.missiles if math.isfinite(m.launch_s)]
        if not flown:
            return 0.0, self.duration_s
        ends = [m.end_s if math.isfinite(m.end_s) else flight.duration_s for m, flight in flown]
        return max(min(m.launch_s for m, _ in flown) - LEAD_S, 0.0), min(max(ends) + LEAD_S, self.duration_s)


@dataclass(frozen=True)
class Sight:
    """How curves are looked at."""

    over: bool = False
    """Both flights in one figure instead of side by side."""
    whole: bool = False
    """The whole flights instead of the time in which missiles fly, as in Fig. 12."""


class ChartPair:
    """Figures of one kind on common scales: one per flight, or one for both; each is made when first asked for."""

    def __init__(self, make: Callable[[str], FlightChart], y_range: Range1d | None = None) -> None:
        """Take a maker of empty figures for an evader's colour, and the vertical range to fit, if there is one."""
        self._make = make
        self._y_range = y_range
        self.over: OverlaidChart | None = None

    @cached_property
    def a(self) -> FlightChart:
        """The figure of flight A."""
        return self._make(POLICY_A)

    @cached_property
    def b(self) -> FlightChart:
        """The figure of flight B."""
        return self._make(POLICY_B)

    def figures(self, over: bool) -> list[figure]:
        """What is drawn."""
        if not over:
            return [self.a.figure, self.b.figure]
        if self.over is None:
            self.over = overlay(self._make(POLICY_A))
        return [self.over.first.figure]

    def show(self, pair: Pair, over: bool = False) -> None:
        """Show these flights, one figure each or both in one."""
        drawn = self.figures(over)
        if self.over is not None and over:
            self.over.show(pair.a, pair.b, f"{pair.title_a} (solid)   ·   {pair.title_b} (dotted)")
            _show_guide(self.over.first, pair.a, None)
            sources = [self.over.first.source, self.over.source]
        else:
            for chart, flight, title, guide in zip((self.a, self.b), *pair.columns, strict=True):
                chart.show(flight, title)
                _show_guide(chart, flight, guide)
            sources = [self.a.source, self.b.source]
        for fig in drawn[1:]:
            fig.yaxis.axis_label = None
        if self._y_range is not None:
            low, high = _span(*sources)
            room = (high - low) * ROOM
            low, high = low - room if low < 0.0 else 0.0, high + room
            fit(self._y_range, low, high, (low, high))


def _with_clock(chart: FlightChart) -> FlightChart:
    chart.figure.tags = [CURSOR_TAG]
    return chart


def _show_guide(chart: FlightChart, flight: Trajectory, guide: GuideTrace | None) -> None:
    if isinstance(chart, ActionChart):
        chart.show_guide(flight, guide)


def fit(axis: Range1d, low: float, high: float, bounds: tuple[float, float]) -> None:
    """Set a range, what its reset tool comes back to, and how far it can be moved."""
    axis.update(start=low, end=high, reset_start=low, reset_end=high, bounds=bounds)


class ChartPairs:
    """The figures by tab; each is made when its tab is first opened, as a figure costs 0.05 s."""

    tabs: ClassVar[dict[str, tuple[str, ...]]] = {
        "Azimuth": ("azimuth",),
        "Range": ("range", "closure"),
        "Speed": ("speed", "energy"),
        "Control": ("action", "bank", "load"),
        "Reward": ("reward",),
        "Map": ("map",),
    }
    """Titles of the tabs and the kinds of figures in them, from top to bottom."""

    def __init__(self, scenario: Scenario) -> None:
        self._field = scenario.battlefield
        self._missiles = range(1, scenario.launch.missiles + 1)
        self.time = Range1d(0.0, 1.0)
        """One range for all curves: who zooms into one has zoomed into all."""
        self.made: dict[str, ChartPair] = {}

    def pair(self, kind: str) -> ChartPair:
        """The figures of one kind."""
        if kind not in self.made:
            self.made[kind] = self._new(kind)
        return self.made[kind]

    def fit_time(self, pair: Pair, sight: Sight) -> None:
        """Show the whole flights, or the time in which missiles fly; panning leads to the rest."""
        low, high = (0.0, pair.duration_s) if sight.whole else pair.engagement_s
        fit(self.time, low, high, (0.0, pair.duration_s))

    def _new(self, kind: str) -> ChartPair:
        missiles, x, y = self._missiles, self.time, Range1d(0.0, 1.0)
        places = map_ranges(self._field)
        makers: dict[str, Callable[[str], FlightChart]] = {
            "azimuth": lambda _ink: azimuth_chart(missiles, HEIGHT, x),
            "range": lambda _ink: range_chart(missiles, HALF_HEIGHT, x, y),
            "closure": lambda _ink: closure_chart(missiles, HALF_HEIGHT, x, y),
            "speed": lambda ink: speed_chart(missiles, HALF_HEIGHT, x, y, ink),
            "energy": lambda _ink: energy_chart(missiles, HALF_HEIGHT, x, y),
            "action": lambda ink: action_chart(HALF_HEIGHT, x, ink),
            "bank": lambda ink: bank_chart(LOW_HEIGHT, x, y, ink),
            "load": lambda ink: load_chart(LOW_HEIGHT, x, y, ink),
            "reward": lambda _ink: reward_chart(missiles, HEIGHT, x, y),
            "map": lambda ink: _with_clock(map_chart(self._field, missiles, MAP_HEIGHT, ink, places)),
        }
        return ChartPair(makers[kind], None if kind in ("azimuth", "action", "map") else y)


def _span(*sources: ColumnDataSource) -> tuple[float, float]:
    columns = [np.asarray(values) for source in sources for values in list(source.data.values())[1:]]
    finite = np.concatenate([values[np.isfinite(values)] for values in columns] + [np.array([0.0, 1.0])])
    return float(finite.min()), float(finite.max())
