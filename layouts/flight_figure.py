"""A static picture of one engagement, drawn without a browser: what the Fly page shows of it, on one sheet."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Literal

from layouts.captions import caption, closest_miss_m, distance_text, outcome_text
from layouts.flight_panels import (
    INK,
    SHAPES,
    draw_azimuth,
    draw_map,
    draw_range,
    draw_reward,
    draw_speed,
    list_events,
    mark_events,
)
from layouts.picture_text import picture_text
from layouts.theme import FAILURE, GATE, INTERCEPTOR, POLICY_A, SUCCESS, missile_colour
from sim.trajectory import Trajectory
from sim.world import Fate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE_IN = (14.0, 10.0)
DPI = 120
LEFT, MAP_HEIGHT = 0.05, 0.355
"""Of the sheet: its left margin, and the height of the map."""

NAME_LENGTH = 90
"""Characters of the caption that fit on the sheet; the end of a longer one is kept."""

LEAD_S = 15.0
"""Seconds shown before the first launch and after the last missile's end, where panels show the engagement only."""


def picture(flight: Trajectory, kind: Literal["png", "svg"]) -> bytes:
    """The picture as a file: `png` is 1680 x 1200 pixels, `svg` scales."""
    from matplotlib import rc_context

    buffer = io.BytesIO()
    # No date and no random names inside: equal flights give equal pictures.
    metadata = {"Title": caption(flight)} | ({"Date": None} if kind == "svg" else {})
    with rc_context({"svg.hashsalt": "flight"}):
        flight_figure(flight).savefig(buffer, format=kind, dpi=DPI, metadata=metadata)
    return buffer.getvalue()


def flight_figure(flight: Trajectory) -> Figure:
    """Title; map and events; azimuths and ranges while missiles fly; speeds and rewards of the whole flight; legend."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from layouts.paper_sheet import plain

    # Not pyplot: it would keep every figure, and look for a screen.
    figure = Figure(figsize=SIZE_IN, facecolor="white")
    FigureCanvasAgg(figure)
    _title(figure, flight)
    place = figure.add_axes((LEFT, 0.55, 0.7, MAP_HEIGHT))
    draw_map(place, flight)
    list_events(figure.add_axes((_fit_width(place) + 0.02, 0.55, 0.235, MAP_HEIGHT)), flight)
    low = figure.add_gridspec(2, 2, left=LEFT, right=0.985, top=0.495, bottom=0.085, hspace=0.16, wspace=0.12)
    azimuth, speed, distance, reward = (figure.add_subplot(cell) for cell in low)
    window_s = engagement_s(flight)
    draw_azimuth(azimuth, flight)
    draw_range(distance, flight, window_s)
    draw_speed(speed, flight)
    draw_reward(reward, flight)
    _share_time((azimuth, distance), window_s, "time [s], while missiles fly", flight)
    _share_time((speed, reward), whole_s(flight), "time [s], the whole flight", flight)
    for axes in (place, azimuth, distance, speed, reward):
        plain(axes, size=9.0)
    _legend(figure, flight)
    return figure


def engagement_s(flight: Trajectory) -> tuple[float, float]:
    """From shortly before the first launch to shortly after the last missile's end; the whole flight without any."""
    flown = [m for m in flight.missiles if math.isfinite(m.launch_s)]
    if not flown:
        return whole_s(flight)
    ends = [m.end_s if math.isfinite(m.end_s) else flight.duration_s for m in flown]
    return max(min(m.launch_s for m in flown) - LEAD_S, 0.0), max(ends) + LEAD_S


def whole_s(flight: Trajectory) -> tuple[float, float]:
    """The whole flight and a little room behind its last instant, or a second of one that ended at once."""
    return 0.0, max(1.01 * flight.duration_s, 1.0)


def _title(figure: Figure, flight: Trajectory) -> None:
    words = caption(flight)
    words = words if len(words) <= NAME_LENGTH else f"… {words[2 - NAME_LENGTH :]}"
    evaded = sum(missile.fate is Fate.EVADED for missile in flight.missiles)
    fates = [f"{evaded} of {len(flight.missiles)} missiles evaded", f"closest {distance_text(closest_miss_m(flight))}"]
    numbers = [
        f"return {flight.episode_return:.1f}",
        f"{flight.duration_s:.0f} s flown",
        *(fates if flight.missiles else ["no missiles"]),
        f"scenario {flight.task.scenario.name}",
    ]
    ink = SUCCESS if flight.success else FAILURE
    words, families = picture_text(words)
    figure.text(LEFT, 0.962, words, fontsize=16, fontweight="bold", color=INK, parse_math=False, family=families)
    result = figure.text(LEFT, 0.93, outcome_text(flight), fontsize=12, fontweight="bold", color=ink)
    result_end = result.get_window_extent().transformed(figure.transFigure.inverted()).x1
    figure.text(result_end + 0.012, 0.93, "  ·  ".join(numbers), fontsize=12, color=INK, parse_math=False)


def _fit_width(place: Axes) -> float:
    """Make the map as wide as its field asks for, at most as it is; returns its right edge."""
    (left, right), (bottom, top) = place.get_xlim(), place.get_ylim()
    box = place.get_position(original=True)
    width = min(box.width, box.height * SIZE_IN[1] / SIZE_IN[0] * (right - left) / (top - bottom))
    place.set_position((box.x0, box.y0, width, box.height))
    return box.x0 + width


def _share_time(panels: tuple[Axes, Axes], window_s: tuple[float, float], label: str, flight: Trajectory) -> None:
    upper, lower = panels
    for axes in panels:
        axes.set_xlim(*window_s)
        mark_events(axes, flight, symbols=axes is upper)
    upper.tick_params(labelbottom=False)
    lower.set_xlabel(label)


def _legend(figure: Figure, flight: Trajectory) -> None:
    from matplotlib.lines import Line2D

    inks = {"evader": POLICY_A, "interceptor": INTERCEPTOR}
    inks |= {f"missile {number}": missile_colour(number) for number in flight.task.missiles} | {"exit gate": GATE}
    entries = [Line2D([], [], color=colour, linewidth=2.5, label=name) for name, colour in inks.items()]
    shapes = {"launch": "launch", "closest": "closest", "evaded": "evaded, start", "shot_down": "hit"}
    shapes |= {"branch": "branch"} if flight.departure else {}
    entries += [
        Line2D([], [], color=INK, marker=SHAPES[kind], linestyle="", markersize=6, label=words,
               markerfacecolor="white" if kind == "evaded" else INK)
        for kind, words in shapes.items()
    ]  # fmt: skip
    figure.legend(
        handles=entries,
        loc="lower center",
        ncols=len(entries),
        frameon=False,
        fontsize=9,
        columnspacing=1.0,
        handlelength=1.3,
        handletextpad=0.5,
    )
