"""Flights as a Rerun recording: a prefix per policy, one clock, and the blueprint that shows them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from layouts.azimuth import azimuth_columns
from layouts.battlefield import EXAGGERATION, GATE_KM, drawing_scale
from layouts.chart import Columns
from layouts.map2d import named_tracks
from layouts.motion import KM, motion
from layouts.ranges import range_columns
from layouts.recording_clock import CLOCK
from layouts.scene import TAIL_POINTS, TAIL_S
from layouts.theme import DARK, GATE, INTERCEPTOR, Rgb, missile_colour, rgb
from sim.scenario import Battlefield
from sim.trajectory import Trajectory
from sim.world import Outcome

APPLICATION = "submas-workbench"
"""No dot in it: Rerun would rename the application."""

TRACK_EVERY_S = 0.5
ORIGIN = np.zeros(3)
HIDDEN = rrb.PlotLegend(visible=False)


def log_flight(recording: rr.RecordingStream, prefix: str, flight: Trajectory, colour: str) -> None:
    """Write one flight under `/prefix`: tracks and trails [km], azimuths, ranges, events."""
    recording.log(prefix, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    _log_field(recording, f"{prefix}/space/field", flight.task.scenario.battlefield)
    for name, _track in named_tracks(flight):
        ink = colour if name == "evader" else INTERCEPTOR
        if name.startswith("missile"):
            ink = missile_colour(int(name.split("_")[1]))
        _log_body(recording, f"{prefix}/space/{name}", flight, name, rgb(ink))
    _log_curves(recording, f"{prefix}/azimuth", azimuth_columns(flight), "_deg")
    _log_curves(recording, f"{prefix}/range", range_columns(flight), "_km")
    _log_events(recording, f"{prefix}/events", flight)


def compare_blueprint(titles: Mapping[str, str], duration_s: float, scale: float = 1.0) -> rrb.Blueprint:
    """One column per prefix: the engagement above, its azimuth and range curves below; panels hidden, paused.

    Args:
        titles: words for each prefix, left to right.
        duration_s: length of the longest flight, which the curves show [s].
        scale: size of the battlefield relative to the usual one (`layouts.battlefield.drawing_scale`).
    """
    span = _whole(duration_s)
    columns = [
        rrb.Vertical(
            _space_view(prefix, title, scale),
            _azimuth_view(prefix, span),
            _range_view(prefix, span),
            row_shares=[3, 1.4, 1.4],
        )
        for prefix, title in titles.items()
    ]
    clock = rrb.TimePanel(state="collapsed", timeline=CLOCK, playback_speed=10.0, play_state="paused", loop_mode="off")
    hidden = [
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TopPanel(state="hidden"),
    ]
    return rrb.Blueprint(rrb.Horizontal(*columns), clock, *hidden, auto_views=False)


def _space_view(prefix: str, title: str, scale: float) -> rrb.Spatial3DView:
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(-20.0 * scale, -140.0 * scale, 112.0 * scale),
        look_target=(0.0, -8.0 * scale, 8.0 * scale),
        eye_up=(0, 0, 1),
    )
    grid = rrb.LineGrid3D(visible=False)
    return rrb.Spatial3DView(
        origin=f"/{prefix}/space",
        name=title,
        eye_controls=eye,
        line_grid=grid,
        background=list(DARK.background),
    )


def _azimuth_view(prefix: str, span: rrb.TimeAxis) -> rrb.TimeSeriesView:
    axis = rrb.ScalarAxis(range=(-180.0, 180.0), zoom_lock=True)
    return rrb.TimeSeriesView(
        origin=f"/{prefix}/azimuth", name="missile azimuth [deg]", axis_x=span, axis_y=axis, plot_legend=HIDDEN
    )


def _range_view(prefix: str, span: rrb.TimeAxis) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(origin=f"/{prefix}/range", name="range [km]", axis_x=span, plot_legend=HIDDEN)


def _whole(duration_s: float) -> rrb.TimeAxis:
    ends = [rr.TimeRangeBoundary.absolute(seconds=seconds) for seconds in (0.0, duration_s)]
    return rrb.TimeAxis(view_range=rr.TimeRange(start=ends[0], end=ends[1]))


def _clock(time_s: NDArray[np.floating]) -> list[rr.TimeColumn]:
    return [rr.TimeColumn(CLOCK, duration=np.asarray(time_s, dtype=float))]


def _log_field(recording: rr.RecordingStream, path: str, field: Battlefield) -> None:
    x, y = field.length_m * KM / 2, field.width_m * KM / 2
    border = [(-x, -y, 0.0), (x, -y, 0.0), (x, y, 0.0), (-x, y, 0.0), (-x, -y, 0.0)]
    recording.log(
        f"{path}/border", rr.LineStrips3D([border], colors=[DARK.border], radii=rr.Radius.ui_points(1.0)), static=True
    )
    low, high = ((field.exit_y_m + side * field.exit_half_width_m) * KM for side in (-1, 1))
    top = GATE_KM * EXAGGERATION * drawing_scale(field)
    gate = [(x, low, 0.0), (x, high, 0.0), (x, high, top), (x, low, top), (x, low, 0.0)]
    ink = rr.LineStrips3D([gate], colors=[rgb(GATE)], radii=rr.Radius.ui_points(2.0))
    recording.log(f"{path}/exit", ink, static=True)


def _log_body(recording: rr.RecordingStream, path: str, flight: Trajectory, name: str, ink: Rgb) -> None:
    body = motion(dict(named_tracks(flight))[name], flight.time_s, EXAGGERATION, ORIGIN)
    if not body.flies:
        return
    times = np.arange(body.time_s[0], body.time_s[-1], TRACK_EVERY_S)
    points = body.position(times)
    # Names of missiles would cover each other; their colours tell them apart.
    label = {} if name.startswith("missile") else {"labels": [name]}
    recording.log(path, rr.Points3D.from_fields(colors=[ink], radii=[rr.Radius.ui_points(6.0)], **label), static=True)
    recording.send_columns(path, _clock(times), rr.Points3D.columns(positions=points))
    whole = rr.LineStrips3D([points], colors=[(*ink, 90)], radii=rr.Radius.ui_points(0.8))
    recording.log(f"{path}_path", whole, static=True)
    tails = [_polyline(body.tail(float(t), TAIL_S, TAIL_POINTS)) for t in times]
    line = rr.LineStrips3D.from_fields(colors=[ink], radii=[rr.Radius.ui_points(2.0)])
    recording.log(f"{path}_tail", line, static=True)
    recording.send_columns(f"{path}_tail", _clock(times), rr.LineStrips3D.columns(strips=tails))
    shot = name == "evader" and flight.outcome is Outcome.SHOT_DOWN
    if shot or body.time_s[-1] < flight.time_s[-1] - TRACK_EVERY_S:
        recording.set_time(CLOCK, duration=float(times[-1]) + TRACK_EVERY_S)
        recording.log(path, rr.Clear(recursive=False))
        recording.log(f"{path}_tail", rr.Clear(recursive=False))


def _polyline(pieces: NDArray[np.floating]) -> NDArray[np.floating]:
    return np.concatenate([pieces[:, 0], pieces[-1:, 1]])


def _log_curves(recording: rr.RecordingStream, path: str, columns: Columns, unit: str) -> None:
    times = columns["time_s"]
    for name, values in list(columns.items())[1:]:
        shown = name.removesuffix(unit)
        ink = rgb(missile_colour(int(shown.split("_")[1]))) if shown.startswith("missile") else rgb(INTERCEPTOR)
        label = shown.replace("_", " ")
        recording.log(f"{path}/{shown}", rr.SeriesLines(colors=ink, names=label, widths=2.0), static=True)
        scalars = rr.Scalars.columns(scalars=values.astype(float))
        recording.send_columns(f"{path}/{shown}", _clock(times), scalars)


def _log_events(recording: rr.RecordingStream, path: str, flight: Trajectory) -> None:
    for event in flight.events:
        recording.set_time(CLOCK, duration=event.time_s)
        recording.log(path, rr.TextLog(event.text))
