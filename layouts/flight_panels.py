"""The panels of the static picture of a flight: map, azimuths, ranges, speeds, rewards, list of events."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from layouts.azimuth import azimuth_columns, end_columns
from layouts.chart import Columns, largest
from layouts.map2d import KM, MARGIN, map_columns, mark_columns
from layouts.ranges import range_columns
from layouts.rewards import GOAL_INK, TIME_INK, reward_columns
from layouts.speeds import speed_columns
from layouts.theme import BRANCH, FAILURE, GATE, INTERCEPTOR, NEUTRAL, POLICY_A, SUCCESS, missile_colour
from sim.scenario import Battlefield
from sim.trajectory import Event, Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK = "#1f2733"
SHAPES = {"launch": "v", "closest": "D", "evaded": "o", "shot_down": "X", "branch": ">"}
"""Marker of an event by its kind; its colour is the missile's, and evaded ones are hollow."""

ENDINGS = {"exit": SUCCESS, "branch": BRANCH}
_TRACK_STEPS_S = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)
_TRACK_LABELS = 12
_CURVE: dict[str, Any] = {"linewidth": 1.6, "solid_capstyle": "round", "solid_joinstyle": "round"}


def body_colour(name: str) -> str:
    """Ink of `evader`, `interceptor` or `missile_k`."""
    if name.startswith("missile_"):
        return missile_colour(int(name.split("_")[1]))
    return POLICY_A if name == "evader" else INTERCEPTOR


def event_colour(event: Event) -> str:
    """Ink of an event: its missile's, or that of a branch, of success or of failure."""
    return missile_colour(event.missile) if event.missile else ENDINGS.get(event.kind, FAILURE)


def draw_map(axes: Axes, flight: Trajectory) -> None:
    """Battlefield, exit gate, tracks, starts, launches and ends from above (Fig. 2) [km], equal scales."""
    columns, field = map_columns(flight), flight.task.scenario.battlefield
    _draw_field(axes, field)
    for name in [column.removesuffix("_x_km") for column in columns if column.endswith("_x_km")]:
        style = _CURVE | {"linewidth": 2.0 if name == "evader" else 1.4, "color": body_colour(name)}
        axes.plot(columns[f"{name}_x_km"], columns[f"{name}_y_km"], **style)
    _draw_clock(axes, flight)
    _draw_ends(axes, mark_columns(flight, POLICY_A), ("mark_x_km", "mark_y_km", "mark_marker", "mark_colour"))
    for missile in flight.missiles:
        flown = np.flatnonzero(np.isfinite(missile.position_m[:, 0]))
        if len(flown):
            x, y = missile.position_m[flown[0], :2] * KM
            draw_mark(axes, x, y, "launch", missile_colour(missile.number))
    if flight.departure is not None:
        now = int(np.abs(flight.time_s - flight.departure.time_s).argmin())
        draw_mark(axes, *(flight.evader.position_m[now, :2] * KM), "branch", BRANCH)
    x_limits, y_limits = (_limits(columns, axis, side * KM) for axis, side in zip("xy", _sides(field), strict=True))
    axes.set(xlabel="x [km]", ylabel="y [km]", xlim=x_limits, ylim=y_limits)
    axes.set_aspect("equal", adjustable="box")


def draw_azimuth(axes: Axes, flight: Trajectory) -> None:
    """Azimuth of every missile [deg] with lines at ±90° (Fig. 12), left of the nose positive."""
    for height in (-90.0, 90.0):
        axes.axhline(height, color=NEUTRAL, linestyle=(0, (1, 2)), linewidth=1.4)
    _draw_curves(axes, azimuth_columns(flight), "_deg")
    _draw_ends(axes, end_columns(flight), ("end_time_s", "end_azimuth_deg", "end_marker", "end_colour"))
    axes.set(ylabel="azimuth [deg]", ylim=(-180.0, 180.0), yticks=[-180, -90, 0, 90, 180])


def draw_range(axes: Axes, flight: Trajectory, window_s: tuple[float, float]) -> None:
    """Distances from the evader [km] in a window of time; marks where missiles came closest."""
    columns = range_columns(flight)
    _draw_curves(axes, columns, "_km")
    for event in flight.events:
        if event.kind in ("closest", "shot_down") and math.isfinite(event.distance_m):
            draw_mark(axes, event.time_s, event.distance_m * KM, event.kind, event_colour(event))
    inside = (columns["time_s"] >= window_s[0]) & (columns["time_s"] <= window_s[1])
    farthest = largest({name: values[inside] for name, values in columns.items()})
    axes.set(ylabel="range [km]", ylim=(0.0, 1.08 * farthest))


def draw_speed(axes: Axes, flight: Trajectory) -> None:
    """Speeds of all bodies [m/s]."""
    _draw_curves(axes, speed_columns(flight), "_m_s")
    axes.set(ylabel="speed [m/s]")
    axes.set_ylim(bottom=0.0)


def draw_reward(axes: Axes, flight: Trajectory) -> None:
    """The return as it is paid, and its terms (Eq. 9): goal, missiles, time."""
    inks: dict[str, dict[str, Any]] = {
        "goal": {"color": GOAL_INK, "linestyle": (0, (5, 2)), "label": "goal"},
        "time": {"color": TIME_INK, "linestyle": (0, (2, 2)), "label": "time"},
        "total": {"color": INK, "linewidth": 2.0, "label": "return", "zorder": 3},
    }
    columns = reward_columns(flight)
    time_s = np.append(0.0, columns["time_s"])
    for name, values in list(columns.items())[1:]:
        style = {"linewidth": 1.4} | (inks.get(name) or {"color": body_colour(name)})
        axes.plot(time_s, np.append(0.0, values), **style)
    axes.set(ylabel="cumulative reward")
    axes.legend(loc="upper left", frameon=False, fontsize=8, ncols=3, handlelength=2.4)


def mark_events(axes: Axes, flight: Trajectory, symbols: bool) -> None:
    """A thin line at every event but closest approaches; `symbols` puts its shape above the panel."""
    low, high = axes.get_xlim()
    for event in flight.events:
        if low <= event.time_s <= high and event.kind != "closest":
            axes.axvline(event.time_s, color=event_colour(event), linewidth=0.8, alpha=0.45, zorder=1)
            if symbols and event.kind in SHAPES:
                draw_mark(axes, event.time_s, 1.04, event.kind, event_colour(event), axes.get_xaxis_transform())


def list_events(axes: Axes, flight: Trajectory) -> None:
    """All events as text, as small as their number demands: time, shape, words."""
    axes.set_axis_off()
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    row = min(0.062, 1.0 / max(len(flight.events), 1))
    for number, event in enumerate(flight.events):
        y = 1.0 - row * (number + 0.5)
        style: dict[str, Any] = {"fontsize": min(9.0, 150.0 * row), "va": "center", "color": INK, "parse_math": False}
        axes.text(0.14, y, f"{event.time_s:.0f} s", ha="right", **style)
        draw_mark(axes, 0.2, y, event.kind, event_colour(event))
        axes.text(0.25, y, event.text, **style)


def draw_mark(axes: Axes, x: float, y: float, kind: str, colour: str, transform: Any = None) -> None:
    """The marker of an event; a square for those without a shape of their own."""
    face = "white" if kind == "evaded" else colour
    where = {} if transform is None else {"transform": transform}
    axes.plot(
        x, y, SHAPES.get(kind, "s"), color=colour, markerfacecolor=face, markeredgewidth=1.2, clip_on=False, zorder=5,
        markersize={"shot_down": 7.0, "closest": 4.5}.get(kind, 5.5), **where,
    )  # fmt: skip


def _draw_curves(axes: Axes, columns: Columns, unit: str) -> None:
    for name, values in list(columns.items())[1:]:
        axes.plot(columns["time_s"], values, color=body_colour(name.removesuffix(unit)), **_CURVE)


def _draw_ends(axes: Axes, marks: dict[str, list[Any]], names: tuple[str, str, str, str]) -> None:
    for x, y, marker, colour in zip(*(marks[name] for name in names), strict=True):
        draw_mark(axes, x, y, "shot_down" if marker == "x" else "evaded", colour)


def _draw_field(axes: Axes, field: Battlefield) -> None:
    x, y = (side * KM / 2 for side in _sides(field))
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y), (-x, -y)])
    axes.fill(*corners.T, color=NEUTRAL, alpha=0.07, zorder=0)
    axes.plot(*corners.T, color=NEUTRAL, linewidth=0.9)
    low, high = ((field.exit_y_m + side * field.exit_half_width_m) * KM for side in (-1, 1))
    axes.plot([x, x], [low, high], color=GATE, linewidth=5, solid_capstyle="butt", zorder=3)


def _draw_clock(axes: Axes, flight: Trajectory) -> None:
    """Dots on the evader's track at round times."""
    from matplotlib.patheffects import withStroke

    step = next((s for s in _TRACK_STEPS_S if flight.duration_s / s <= _TRACK_LABELS), _TRACK_STEPS_S[-1])
    halo = [withStroke(linewidth=2.5, foreground="white")]
    for time_s in np.arange(step, flight.duration_s, step):
        place = [float(np.interp(time_s, flight.time_s, flight.evader.position_m[:, axis])) * KM for axis in (0, 1)]
        axes.plot(*place, "o", color=POLICY_A, markersize=3.5, zorder=3)
        axes.annotate(
            f"{time_s:.0f} s", place, (0, -10), textcoords="offset points", fontsize=7, color=POLICY_A, ha="center",
            path_effects=halo, zorder=4,
        )  # fmt: skip


def _sides(field: Battlefield) -> tuple[float, float]:
    return field.length_m, field.width_m


def _limits(columns: Columns, axis: str, side_km: float) -> tuple[float, float]:
    """Ends of an axis that show the whole field, and tracks that leave it."""
    places = [_finite(values) for name, values in columns.items() if name.endswith(f"_{axis}_km")]
    every = np.concatenate([*places, [-side_km / 2, side_km / 2]])
    room = MARGIN * side_km / 2
    return float(every.min()) - room, float(every.max()) + room


def _finite(values: Any) -> Any:
    return values[np.isfinite(values)]
