"""What the evader does: the turn its policy asks for, the guide's turn beside it, bank and load factor."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from bokeh.models import ColumnDataSource, FixedTicker, LegendItem, Range1d
from numpy.typing import NDArray

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, dotted, empty, thin_index
from layouts.energy import GRAVITY_M_S2
from layouts.theme import NEUTRAL, POLICY_A
from sim.trajectory import BodyTrack, Trajectory

LIMIT_DEG = 90.0
GUIDE_INK = "#8c8f1f"
ACTION_COLUMNS = ("time_s", "action_deg", "guide_deg")
BAND_COLUMNS = ("from_s", "to_s")


@dataclass(frozen=True)
class GuideTrace:
    """The guide of a learned policy along one flight of K steps; made by the application."""

    guide: str
    """Its name."""
    fresh: tuple[int, ...]
    """Missiles that the policy learned about and the guide does not know."""
    allowed: NDArray[np.bool_]
    """`[K]` whether the transfer condition (Eq. 13) held."""
    action_rad: NDArray[np.float64]
    """`[K]` the turn the guide would have asked for."""


@dataclass(frozen=True)
class ActionChart(FlightChart):
    """Actions, and the guide's when there is one: its curve, and a shade where transfer was prevented."""

    bands: ColumnDataSource = field(default_factory=lambda: empty(BAND_COLUMNS))

    def show_guide(self, flight: Trajectory, trace: GuideTrace | None) -> None:
        """Show this guide beside the flight shown, or none."""
        columns = dict(self.source.data)
        times = np.asarray(columns["time_s"])
        columns["guide_deg"] = np.full(len(times), np.nan) if trace is None else guide_deg(flight, trace)
        self.source.data = columns
        self.bands.data = prevented_bands(flight, trace)
        for item in self.figure.legend[0].items:
            if item.renderers[0].name in ("guide_deg", "prevented"):
                item.visible = trace is not None


def load_factor(track: BodyTrack, time_s: NDArray[np.floating]) -> NDArray[np.float64]:
    """Load factor `[T]` [g] from the path: what turning and gravity ask of the wings; 1 when level."""
    if len(time_s) < 2:
        return np.ones(len(time_s))
    turn = np.gradient(np.unwrap(track.heading_rad), time_s)
    climb = np.gradient(track.pitch_rad, time_s)
    sideways = track.speed_m_s * np.cos(track.pitch_rad) * turn / GRAVITY_M_S2
    upwards = track.speed_m_s * climb / GRAVITY_M_S2 + np.cos(track.pitch_rad)
    return np.hypot(sideways, upwards)


def action_columns(trajectory: Trajectory) -> Columns:
    """`time_s`, `action_deg` with a sample at both ends of every step, and an empty `guide_deg`."""
    action = np.degrees(np.repeat(trajectory.action_rad, 2))
    return {"time_s": step_edges(trajectory), "action_deg": action, "guide_deg": np.full(len(action), np.nan)}


def guide_deg(trajectory: Trajectory, trace: GuideTrace) -> NDArray[np.float64]:
    """The guide's turns [deg] with a sample at both ends of every step, `[2 K]`."""
    return np.degrees(np.repeat(trace.action_rad[: len(trajectory.action_rad)], 2))


def step_edges(trajectory: Trajectory) -> NDArray[np.float64]:
    """Begin and end of every decision step, `[2 K]` [s]; the last one may be cut short."""
    begins = trajectory.step_time_s
    ends = np.minimum(begins + trajectory.task.scenario.rules.step_s, trajectory.duration_s)
    return np.stack([begins, ends], axis=1).reshape(-1)


def prevented_bands(trajectory: Trajectory, trace: GuideTrace | None) -> dict[str, NDArray[np.float64]]:
    """Spans of time [s] in which transfer was prevented (Definition 2): `from_s` and `to_s`, none without a guide."""
    if trace is None:
        return {name: np.empty(0) for name in BAND_COLUMNS}
    edges = step_edges(trajectory).reshape(-1, 2)
    change = np.diff(np.concatenate([[0], (~trace.allowed).astype(int), [0]]))
    first, past = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    return {"from_s": edges[first, 0], "to_s": edges[past - 1, 1]}


def body_columns(trajectory: Trajectory) -> Columns:
    """`time_s`, `bank_deg` (left wing down positive) and `load_g` of the evader."""
    index, track = thin_index(len(trajectory.time_s)), trajectory.evader
    load = load_factor(track, trajectory.time_s)
    return {
        "time_s": trajectory.time_s[index],
        "bank_deg": np.degrees(track.bank_rad)[index],
        "load_g": load[index],
    }


def action_chart(height: int = 240, x_range: Range1d | None = None, colour: str = POLICY_A) -> ActionChart:
    """Turns asked for [deg] over time [s], left positive: the policy's and its guide's."""
    source, bands = empty(ACTION_COLUMNS), empty(BAND_COLUMNS)
    fig = chart("turn asked for [deg]", height, x_range, Range1d(-LIMIT_DEG - 8, LIMIT_DEG + 8))
    fig.yaxis.ticker = FixedTicker(ticks=[-90, -45, 0, 45, 90])
    shade = fig.quad(
        left="from_s", right="to_s", bottom=-LIMIT_DEG - 8, top=LIMIT_DEG + 8, source=bands, fill_color=NEUTRAL,
        fill_alpha=0.22, line_color=None, name="prevented", level="underlay",
    )  # fmt: skip
    dotted(fig, 0.0)
    lines = [("action_deg", "policy", colour), ("guide_deg", "its guide", GUIDE_INK)]
    _policy, guide = add_lines(fig, source, "time_s", lines)
    guide.glyph.line_dash = [5, 3]
    fig.legend[0].items.append(LegendItem(label="no transfer (Eq. 13)", renderers=[shade]))
    add_csv(fig, "actions", source)
    return ActionChart(fig, source, action_columns, bands=bands)


def bank_chart(height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None,
               colour: str = POLICY_A) -> FlightChart:  # fmt: skip
    """Bank of the evader [deg] over time [s], left wing down positive."""
    return _body_chart("bank_deg", "bank", "bank [deg]", height, (x_range, y_range), colour)


def load_chart(height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None,
               colour: str = POLICY_A) -> FlightChart:  # fmt: skip
    """Load factor of the evader [g] over time [s]."""
    return _body_chart("load_g", "load factor", "load factor [g]", height, (x_range, y_range), colour)


def _body_chart(
    column: str, label: str, axis: str, height: int, ranges: tuple[Range1d | None, Range1d | None], colour: str
) -> FlightChart:
    source = empty(["time_s", column])
    fig = chart(axis, height, *ranges)
    dotted(fig, 0.0)
    add_lines(fig, source, "time_s", [(column, label, colour)])
    add_csv(fig, column.partition("_")[0], source)
    return FlightChart(fig, source, lambda flight: _only(body_columns(flight), column))


def _only(columns: Columns, column: str) -> Columns:
    return {name: columns[name] for name in ("time_s", column)}
