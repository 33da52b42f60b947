"""Azimuth curves of two policies on the same engagement, side by side, as a picture (Fig. 12)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from layouts.azimuth import HALF_TURN_DEG, wrap_gaps
from layouts.paper_panels import AzimuthPanel
from layouts.paper_sheet import INK, name, plain, sheet
from layouts.theme import NEUTRAL, ink_dash, missile_colour

SIZE_IN = (11.6, 4.6)


def azimuth_figure(panels: Sequence[AzimuthPanel], caption: str) -> Figure:
    """Fig. 12: a panel for each policy, a curve for each missile, lines at ±90°."""
    figure = sheet("Fig. 12  Azimuth of the missiles while they are evaded", caption, SIZE_IN)
    grid = figure.add_gridspec(1, 2, left=0.065, right=0.985, top=0.78, bottom=0.25, wspace=0.08)
    for column, panel in enumerate(panels):
        axes = figure.add_subplot(grid[0, column])
        _draw(axes, panel)
        axes.set_ylabel("azimuth [deg], left positive" if column == 0 else "")
        axes.tick_params(labelleft=column == 0)
    handles, labels = figure.axes[0].get_legend_handles_labels() if figure.axes else ([], [])
    figure.legend(
        handles, labels, loc="upper left", bbox_to_anchor=(0.01, 0.92), ncols=max(len(labels), 1), frameon=False,
        fontsize=9.5, labelcolor=INK,
    )  # fmt: skip
    return figure


def _draw(axes: Axes, panel: AzimuthPanel) -> None:
    for height in (-90.0, 90.0):
        axes.axhline(height, color=NEUTRAL, linestyle=(0, (1, 2)), linewidth=1.4)
    for missile, angles in panel.azimuth_deg.items():
        colour = missile_colour(missile)
        columns = wrap_gaps({"time_s": panel.time_s, "angle": angles})
        axes.plot(columns["time_s"], columns["angle"], color=colour, linewidth=1.8, linestyle=ink_dash(colour),
                  label=f"missile {missile}")  # fmt: skip
        flown = np.flatnonzero(np.isfinite(angles))
        if len(flown):
            last = flown[-1]
            axes.plot(panel.time_s[last], angles[last], "o", mfc="white", mec=colour, clip_on=False, zorder=3)
    axes.set(xlabel="time [s]", ylim=(-HALF_TURN_DEG, HALF_TURN_DEG), yticks=[-180, -90, 0, 90, 180])
    axes.set_xlim(panel.time_s[0], panel.time_s[-1])
    name(axes, panel.title)
    plain(axes)
