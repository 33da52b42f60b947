"""The engagement from above (Fig. 2, 10 and 11): battlefield, exit gate, tracks and ends, in kilometres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d
from bokeh.plotting import figure

from layouts.chart import Columns, FlightChart, Marks, add_csv, add_legend, empty, missile_label, plain, thin_index
from layouts.theme import GATE, INTERCEPTOR, NEUTRAL, POLICY_A, ink_dash, missile_colour
from sim.scenario import Battlefield
from sim.trajectory import BodyTrack, MissileTrack, Trajectory
from sim.world import Fate

KM = 1e-3
MARGIN = 0.04
MARK_COLUMNS = ("mark_x_km", "mark_y_km", "mark", "mark_marker", "mark_size", "mark_colour")


def map_columns(trajectory: Trajectory) -> Columns:
    """Ground tracks [km]: `time_s`, then x and y of every body; NaN when not in flight."""
    index = thin_index(len(trajectory.time_s))
    columns: Columns = {"time_s": trajectory.time_s[index]}
    for name, track in named_tracks(trajectory):
        columns[f"{name}_x_km"] = track.position_m[index, 0] * KM
        columns[f"{name}_y_km"] = track.position_m[index, 1] * KM
    return columns


def named_tracks(trajectory: Trajectory) -> list[tuple[str, BodyTrack | MissileTrack]]:
    """Every body of the flight with the name its columns carry."""
    missiles = [(f"missile_{track.number}", track) for track in trajectory.missiles]
    return [("evader", trajectory.evader), ("interceptor", trajectory.interceptor), *missiles]


def map_chart(
    field: Battlefield, missiles: Sequence[int], height: int = 240, evader_colour: str = POLICY_A,
    ranges: tuple[Range1d, Range1d] | None = None,
) -> FlightChart:  # fmt: skip
    """Top view with equal scales; x to the right [km], y up [km]; o starts and evaded missiles, x hit."""
    x_range, y_range = ranges or map_ranges(field)
    fig = figure(
        title=" ", height=height, sizing_mode="stretch_width", match_aspect=True, x_range=x_range, y_range=y_range,
        tools="pan,wheel_zoom,box_zoom,reset,save", active_drag=None, x_axis_label="x [km]", y_axis_label="y [km]",
    )  # fmt: skip
    plain(fig)
    _draw_field(fig, field)
    bodies = {"evader": evader_colour, "interceptor": INTERCEPTOR}
    bodies |= {f"missile_{m}": missile_colour(m) for m in missiles}
    source = empty(["time_s", *(f"{name}_{axis}_km" for name in bodies for axis in "xy")])
    entries = []
    for name, colour in bodies.items():
        line = fig.line(
            f"{name}_x_km", f"{name}_y_km", source=source, color=colour, line_width=2.2, line_dash=ink_dash(colour),
            name=f"{name}_x_km",
        )  # fmt: skip
        label = missile_label(int(name[8:]), missiles) if name.startswith("missile_") else name
        entries.append((label, [line]))
    add_legend(fig, entries)
    marks = empty(MARK_COLUMNS)
    fig.scatter(
        "mark_x_km", "mark_y_km", marker="mark_marker", size="mark_size", color="mark_colour", source=marks,
        line_width=2, fill_alpha=0.0,
    )  # fmt: skip
    add_csv(fig, "map", source)
    return FlightChart(fig, source, map_columns, marks, lambda flight: mark_columns(flight, evader_colour))


def map_ranges(field: Battlefield) -> tuple[Range1d, Range1d]:
    """Horizontal and vertical range that show the whole battlefield [km]; share them to link two maps."""
    half_x, half_y = (side * KM / 2 * (1 + 2 * MARGIN) for side in (field.length_m, field.width_m))
    return Range1d(-half_x, half_x), Range1d(-half_y, half_y)


def mark_columns(trajectory: Trajectory, evader_colour: str) -> Marks:
    """Starts of both aircraft and the ends of missiles that were evaded or hit."""
    rows = [(*trajectory.evader.position_m[0, :2] * KM, "evader", "circle", 9.0, evader_colour)]
    rows.append((*trajectory.interceptor.position_m[0, :2] * KM, "interceptor", "circle", 9.0, INTERCEPTOR))
    for track in trajectory.missiles:
        flown = np.flatnonzero(np.isfinite(track.position_m[:, 0]))
        if flown.size and track.fate in (Fate.EVADED, Fate.HIT):
            marker, size = ("x", 13.0) if track.fate == Fate.HIT else ("circle", 8.0)
            place = track.position_m[flown[-1], :2] * KM
            rows.append((*place, f"missile_{track.number}", marker, size, missile_colour(track.number)))
    return {name: [row[i] for row in rows] for i, name in enumerate(MARK_COLUMNS)}


def _draw_field(fig: figure, field: Battlefield) -> None:
    half_x, half_y = field.length_m * KM / 2, field.width_m * KM / 2
    fig.quad(
        left=-half_x, right=half_x, bottom=-half_y, top=half_y, fill_alpha=0.05, fill_color=NEUTRAL, line_color=NEUTRAL
    )
    low, high = ((field.exit_y_m + sign * field.exit_half_width_m) * KM for sign in (-1, 1))
    fig.line([half_x, half_x], [low, high], color=GATE, line_width=7)
