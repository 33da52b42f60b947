"""The engagement from above (Fig. 2, 10 and 11): battlefield, exit gate, tracks and ends, in kilometres."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from layouts.chart import Columns, add_csv, add_legend, thin_index
from layouts.theme import GATE, INTERCEPTOR, NEUTRAL, POLICY_A, missile_colour
from sim.scenario import Battlefield
from sim.trajectory import BodyTrack, MissileTrack, Trajectory
from sim.world import Fate

KM = 1e-3
MARGIN = 0.04
BODIES_TAG = "map-bodies"


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


def map_figure(
    trajectory: Trajectory,
    title: str,
    height: int = 240,
    evader_colour: str = POLICY_A,
    ranges: tuple[Range1d, Range1d] | None = None,
) -> figure:
    """Top view with equal scales; x to the right [km], y up [km]."""
    field = trajectory.task.scenario.battlefield
    x_range, y_range = ranges or map_ranges(field)
    fig = figure(
        title=title,
        height=height,
        sizing_mode="stretch_width",
        match_aspect=True,
        x_range=x_range,
        y_range=y_range,
        tools="pan,wheel_zoom,box_zoom,reset,save",
        active_drag=None,
        x_axis_label="x [km]",
        y_axis_label="y [km]",
    )
    fig.toolbar.logo, fig.toolbar.autohide, fig.outline_line_color = None, True, None
    _draw_field(fig, field)
    source = ColumnDataSource(map_columns(trajectory))
    entries = []
    for name, _track in named_tracks(trajectory):
        colour = _colour(name, evader_colour)
        line = fig.line(f"{name}_x_km", f"{name}_y_km", source=source, color=colour, line_width=2.2)
        entries.append((name.replace("_", " "), [line]))
    add_legend(fig, entries)
    _draw_marks(fig, trajectory, evader_colour)
    add_csv(fig, "map", source)
    return fig


def map_ranges(field: Battlefield) -> tuple[Range1d, Range1d]:
    """Horizontal and vertical range that show the whole battlefield [km]; share them to link two maps."""
    half_x, half_y = (side * KM / 2 * (1 + 2 * MARGIN) for side in (field.length_m, field.width_m))
    return Range1d(-half_x, half_x), Range1d(-half_y, half_y)


def _colour(name: str, evader_colour: str) -> str:
    if name == "evader":
        return evader_colour
    return INTERCEPTOR if name == "interceptor" else missile_colour(int(name.split("_")[1]))


def _draw_field(fig: figure, field: Battlefield) -> None:
    half_x, half_y = field.length_m * KM / 2, field.width_m * KM / 2
    fig.quad(
        left=-half_x,
        right=half_x,
        bottom=-half_y,
        top=half_y,
        fill_alpha=0.05,
        fill_color=NEUTRAL,
        line_color=NEUTRAL,
    )
    low, high = ((field.exit_y_m + sign * field.exit_half_width_m) * KM for sign in (-1, 1))
    fig.line([half_x, half_x], [low, high], color=GATE, line_width=7)


def _draw_marks(fig: figure, trajectory: Trajectory, evader_colour: str) -> None:
    start = trajectory.evader.position_m[0, :2] * KM
    fig.scatter([start[0]], [start[1]], marker="circle", size=9, color=evader_colour)
    foe = trajectory.interceptor.position_m[0, :2] * KM
    fig.scatter([foe[0]], [foe[1]], marker="circle", size=9, color=INTERCEPTOR)
    for track in trajectory.missiles:
        flown = np.flatnonzero(np.isfinite(track.position_m[:, 0]))
        if flown.size and track.fate in (Fate.EVADED, Fate.HIT):
            end = track.position_m[flown[-1], :2] * KM
            marker, size = ("x", 13) if track.fate == Fate.HIT else ("circle", 8)
            fig.scatter(
                [end[0]],
                [end[1]],
                marker=marker,
                size=size,
                line_width=2,
                color=missile_colour(track.number),
                fill_alpha=0.0,
            )
