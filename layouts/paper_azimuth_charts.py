"""Fig. 12 to point at: azimuth of every missile in one engagement, a chart for each policy."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, FixedTicker, Range1d
from bokeh.plotting import figure

from layouts.azimuth import HALF_TURN_DEG, wrap_gaps
from layouts.chart import add_csv, add_lines, dotted, plain
from layouts.paper_panels import AzimuthPanel
from layouts.theme import missile_colour

HEIGHT = 330


def azimuth_chart(panel: AzimuthPanel) -> figure:
    """One policy: a curve for each missile over time, open circles where they end, lines at ±90°."""
    fig = figure(
        title=panel.title, height=HEIGHT, sizing_mode="stretch_width", tools="xpan,xwheel_zoom,box_zoom,reset,save",
        active_drag=None, x_axis_label="time [s]", y_axis_label="azimuth [deg], left positive", min_border_right=12,
        x_range=Range1d(float(panel.time_s[0]), float(panel.time_s[-1])),
        y_range=Range1d(-HALF_TURN_DEG, HALF_TURN_DEG),
    )  # fmt: skip
    plain(fig)
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    fig.yaxis.ticker = FixedTicker(ticks=[-180, -90, 0, 90, 180])
    dotted(fig, -90.0, 90.0)
    columns = wrap_gaps({"time_s": panel.time_s, **{f"missile_{k}_deg": a for k, a in panel.azimuth_deg.items()}})
    source = ColumnDataSource(columns)
    lines = [(f"missile_{k}_deg", f"missile {k}", missile_colour(k)) for k in panel.azimuth_deg]
    add_lines(fig, source, "time_s", lines)
    for missile, angles in panel.azimuth_deg.items():
        last = np.flatnonzero(np.isfinite(angles))[-1:]
        fig.scatter(panel.time_s[last], angles[last], size=8, fill_alpha=0.0, line_width=2,
                    line_color=missile_colour(missile))  # fmt: skip
    add_csv(fig, "fig12", source)
    return fig
