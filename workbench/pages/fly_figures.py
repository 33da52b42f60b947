"""The curves of both flights, side by side on common scales, changed in place when other flights are shown."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from bokeh.models import Range1d

from layouts.azimuth import azimuth_chart
from layouts.chart import FlightChart
from layouts.map2d import map_chart, map_ranges
from layouts.ranges import range_chart
from layouts.rewards import reward_chart
from layouts.speeds import speed_chart
from layouts.theme import POLICY_A, POLICY_B
from sim.scenario import Scenario
from sim.trajectory import Trajectory

HEIGHT = 245
MAP_HEIGHT = 380
INKS = (POLICY_A, POLICY_B)
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
class ChartPair:
    """One figure per flight on common scales; `y_range` is fitted to both when there is one."""

    a: FlightChart
    b: FlightChart
    x_range: Range1d | None = None
    y_range: Range1d | None = None
    zoomed: bool = False
    """Show only the time in which missiles fly, as Fig. 12 does; panning leads to the rest."""

    def show(self, pair: Pair) -> None:
        """Show these flights."""
        if self.x_range is not None:
            low, high = pair.engagement_s if self.zoomed else (0.0, pair.duration_s)
            fit(self.x_range, low, high, (0.0, pair.duration_s))
        self.a.show(pair.a, pair.title_a)
        self.b.show(pair.b, pair.title_b)
        if self.y_range is not None:
            low, high = _span(self.a, self.b)
            room = (high - low) * ROOM
            low, high = low - room if low < 0.0 else 0.0, high + room
            fit(self.y_range, low, high, (low, high))


def fit(axis: Range1d, low: float, high: float, bounds: tuple[float, float]) -> None:
    """Set a range, what its reset tool comes back to, and how far it can be moved."""
    axis.update(start=low, end=high, reset_start=low, reset_end=high, bounds=bounds)


class ChartPairs:
    """The pairs of figures by tab title; each is made when it is first asked for, as a figure costs 0.1 s."""

    titles = ("Azimuth", "Range", "Speed", "Reward", "Map")

    def __init__(self, scenario: Scenario) -> None:
        self._field = scenario.battlefield
        self._missiles = range(1, scenario.launch.missiles + 1)
        self._time = Range1d(0.0, 1.0)
        self.made: dict[str, ChartPair] = {}

    def pair(self, title: str) -> ChartPair:
        """The figures of a tab."""
        if title not in self.made:
            makers = {"Azimuth": self._azimuth, "Range": self._range, "Speed": self._speed, "Reward": self._reward}
            self.made[title] = makers.get(title, self._map)()
        return self.made[title]

    def _azimuth(self) -> ChartPair:
        x = Range1d(0.0, 1.0)
        return ChartPair(*(azimuth_chart(self._missiles, HEIGHT, x) for _ in INKS), x, zoomed=True)

    def _range(self) -> ChartPair:
        y = Range1d(0.0, 1.0)
        return ChartPair(*(range_chart(self._missiles, HEIGHT, self._time, y) for _ in INKS), self._time, y)

    def _speed(self) -> ChartPair:
        y = Range1d(0.0, 1.0)
        return ChartPair(*(speed_chart(self._missiles, HEIGHT, self._time, y, ink) for ink in INKS), self._time, y)

    def _reward(self) -> ChartPair:
        y = Range1d(0.0, 1.0)
        return ChartPair(*(reward_chart(self._missiles, HEIGHT, self._time, y) for _ in INKS), self._time, y)

    def _map(self) -> ChartPair:
        places = map_ranges(self._field)
        return ChartPair(*(map_chart(self._field, self._missiles, MAP_HEIGHT, ink, places) for ink in INKS))


def _span(*charts: FlightChart) -> tuple[float, float]:
    columns = [np.asarray(values) for chart in charts for values in list(chart.source.data.values())[1:]]
    finite = np.concatenate([values[np.isfinite(values)] for values in columns] + [np.array([0.0, 1.0])])
    return float(finite.min()), float(finite.max())
