"""Envelopes drawn: around the evader for launch range and aspect, as a rectangle for any other two axes."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from layouts.survival import SHOT_DOWN, STOPS, SURVIVED, Values, edges

Format = Literal["png", "svg"]
SURVIVAL = LinearSegmentedColormap.from_list("survival", STOPS)

INK, FAINT = "#20242b", "#5b6470"
SIZE_IN, DPI = (6.4, 6.6), 120
KILOMETRES_FROM_M = 5e3


@dataclass(frozen=True)
class Scale:
    """One axis of a rectangular map: what it is, in which unit, and the value of every cell, ascending."""

    label: str
    unit: str
    values: tuple[float, ...]


def polar_map(range_m: Values, aspect_rad: Values, survived: Values, title: str, caption: str) -> Figure:
    """Survival `[R, A]` by launch range [m] and side of the shooter [rad]: the evader in the middle, its nose up."""
    figure, axes = _page(title, caption, polar=True)
    assert isinstance(axes, PolarAxes)
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(1)  # left of the nose is positive, and is left in the picture
    around, outward = edges(aspect_rad), edges(range_m / 1e3)
    mesh = axes.pcolormesh(around, outward, survived, cmap=SURVIVAL, vmin=0.0, vmax=1.0, rasterized=True)
    if _is_averaged(survived):
        closed = _is_full_circle(aspect_rad)
        angles = np.append(aspect_rad, aspect_rad[0] + 2.0 * math.pi) if closed else aspect_rad
        shares = np.column_stack([survived, survived[:, 0]]) if closed else survived
        _half_line(axes, angles, range_m / 1e3, shares)
    _rings_and_spokes(axes, outward[-1])
    axes.plot(0.0, 0.0, marker=(3, 0, 0), markersize=11, color=INK, clip_on=False, zorder=5)
    _key(figure, axes, mesh, survived)
    return figure


def grid_map(x: Scale, y: Scale, survived: Values, title: str, caption: str) -> Figure:
    """Survival `[X, Y]` over two axes, x to the right and y upwards."""
    figure, axes = _page(title, caption, polar=False)
    across, up = _shown(x), _shown(y)
    mesh = axes.pcolormesh(
        edges(across), edges(up), survived.T, cmap=SURVIVAL, vmin=0.0, vmax=1.0, rasterized=True
    )  # fmt: skip
    if _is_averaged(survived):
        _half_line(axes, across, up, survived.T)
    axes.set_xlabel(_named(x))
    axes.set_ylabel(_named(y))
    axes.tick_params(colors=INK, labelsize=9)
    _key(figure, axes, mesh, survived)
    return figure


def picture(figure: Figure, kind: Format) -> bytes:
    """The figure as the content of a file; equal figures give equal bytes."""
    content = io.BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": "envelope"}):
        figure.savefig(content, format=kind, dpi=DPI, metadata=metadata)
    return content.getvalue()


def _page(title: str, caption: str, *, polar: bool) -> tuple[Figure, Axes]:
    figure = Figure(figsize=SIZE_IN, facecolor="#ffffff")
    FigureCanvasAgg(figure)
    where = (0.08, 0.17, 0.84, 0.66) if polar else (0.13, 0.2, 0.82, 0.61)
    axes = figure.add_axes(where, projection="polar" if polar else None)
    figure.text(0.03, 0.965, title, fontsize=13, color=INK, va="top", wrap=True)
    figure.text(0.03, 0.025, caption, fontsize=8.5, color=FAINT, va="bottom", linespacing=1.5, wrap=True)
    return figure, axes


def _rings_and_spokes(axes: PolarAxes, outmost_km: float) -> None:
    rings = [
        ring
        for ring in MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(0.0, outmost_km)
        if 0.0 < ring < 0.97 * outmost_km
    ]
    axes.set_rlim(0.0, outmost_km)
    axes.set_rgrids(rings, [f"{ring:g} km" for ring in rings], angle=195.0)
    axes.set_thetagrids(range(0, 360, 30), [_side(degrees) for degrees in range(0, 360, 30)])
    axes.tick_params(axis="x", colors=INK, labelsize=9, pad=12)
    axes.tick_params(axis="y", colors="#ffffff", labelsize=8)
    for label in axes.get_yticklabels():
        label.set_path_effects([withStroke(linewidth=2.0, foreground=INK)])
    axes.grid(color="#ffffff", alpha=0.45, linewidth=0.6)


def _is_averaged(survived: Values) -> bool:
    """Whether a cell holds anything but all or nothing: only then is there a share of one half to draw."""
    return bool(((survived > 0.0) & (survived < 1.0)).any())


def _half_line(axes: Axes, across: Values, up: Values, shares: Values) -> None:
    if min(shares.shape) > 1 and shares.min() < 0.5 < shares.max():
        axes.contour(across, up, shares, levels=[0.5], colors=INK, linewidths=1.2)


def _key(figure: Figure, axes: Axes, mesh: QuadMesh, survived: Values) -> None:
    if not _is_averaged(survived):
        patches = [Patch(color=SHOT_DOWN, label="shot down"), Patch(color=SURVIVED, label="survived")]
        figure.legend(handles=patches, loc="upper right", bbox_to_anchor=(0.98, 0.93), frameon=False, fontsize=9)
        return
    bar = figure.colorbar(mesh, cax=figure.add_axes((0.71, 0.875, 0.24, 0.018)), orientation="horizontal")
    bar.set_ticks([0.0, 0.5, 1.0], labels=["0 %", "50 %", "100 %"])
    bar.ax.tick_params(labelsize=8, colors=INK)
    bar.ax.set_title("survived", fontsize=8.5, color=INK, pad=3)


def _is_full_circle(aspect_rad: Values) -> bool:
    spacing = aspect_rad[1] - aspect_rad[0]
    return abs(aspect_rad[-1] + spacing - aspect_rad[0] - 2.0 * math.pi) < 1e-3 * spacing


def _side(degrees: int) -> str:
    if degrees in (0, 180):
        return "nose" if degrees == 0 else "tail"
    return f"{degrees}° left" if degrees < 180 else f"{360 - degrees}° right"


def _in_kilometres(scale: Scale) -> bool:
    return scale.unit == "m" and scale.values[-1] >= KILOMETRES_FROM_M


def _shown(scale: Scale) -> Values:
    return np.array(scale.values) * (1e-3 if _in_kilometres(scale) else 1.0)


def _named(scale: Scale) -> str:
    unit = "km" if _in_kilometres(scale) else scale.unit
    return f"{scale.label} [{unit}]" if unit else scale.label
