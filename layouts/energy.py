"""What a missile has left to spend: its energy over time, as a curve, as a share and as a colour."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import Range1d
from numpy.typing import NDArray

from layouts.chart import Columns, FlightChart, add_csv, add_lines, chart, empty, missile_label, thin_index
from layouts.theme import DARK, Ground, Rgb, missile_colour
from sim.trajectory import MissileTrack, Trajectory

GRAVITY_M_S2 = 9.80665
SPENT: tuple[Rgb, Rgb] = ((84, 98, 122), (186, 194, 206))
"""Colour of a missile without energy on a dark and on a light ground: it recedes into the ground."""
FULL: tuple[Rgb, Rgb] = ((255, 214, 64), (150, 62, 0))
"""Colour of a missile at its greatest energy: it stands out. The scale runs by lightness."""


def energy_height_m(track: MissileTrack) -> NDArray[np.float64]:
    """Energy per weight h + V²/2g `[T]` [m]: how high it could climb; NaN when not in flight."""
    return track.position_m[:, 2] + track.speed_m_s**2 / (2.0 * GRAVITY_M_S2)


def energy_share(track: MissileTrack) -> NDArray[np.float64]:
    """Energy `[T]` as a share of the greatest this missile had in this flight, 0 to 1; NaN when not in flight."""
    height = energy_height_m(track)
    finite = height[np.isfinite(height)]
    return height / float(finite.max()) if finite.size else height


def energy_colours(share: NDArray[np.floating], look: Ground) -> NDArray[np.uint8]:
    """Colours `[..., 3]` of shares `[...]` on a ground."""
    ground = 0 if look == DARK else 1
    spent, full = np.array(SPENT[ground], float), np.array(FULL[ground], float)
    return np.round(spent + np.clip(share, 0.0, 1.0)[..., None] * (full - spent)).astype(np.uint8)


def energy_columns(trajectory: Trajectory) -> Columns:
    """`time_s` and `missile_k_energy_km`, the energy height; NaN when k is not in flight."""
    index = thin_index(len(trajectory.time_s))
    columns: Columns = {"time_s": trajectory.time_s[index]}
    for track in trajectory.missiles:
        columns[f"missile_{track.number}_energy_km"] = energy_height_m(track)[index] / 1e3
    return columns


def energy_chart(
    missiles: Sequence[int], height: int = 240, x_range: Range1d | None = None, y_range: Range1d | None = None
) -> FlightChart:
    """Energy heights of these missiles [km] over time [s]."""
    lines = [(f"missile_{m}_energy_km", missile_label(m, missiles), missile_colour(m)) for m in missiles]
    source = empty(["time_s", *(line[0] for line in lines)])
    fig = chart("energy h + V²/2g [km]", height, x_range, y_range)
    add_lines(fig, source, "time_s", lines)
    add_csv(fig, "energies", source)
    return FlightChart(fig, source, energy_columns)
