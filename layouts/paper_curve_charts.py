"""Fig. 8 and 9 to point at: learning curves of several algorithms over seeds, one pair of charts for each task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from bokeh.models import ColumnDataSource, GlyphRenderer, HoverTool, Range1d
from bokeh.plotting import figure

from layouts.chart import add_csv, plain
from layouts.paper_inks import ink
from layouts.paper_panels import Band, Panel

HEIGHT = 236
MILLION = 1e6
TIPS = [("", "@name"), ("steps", "@steps{0.00} million"), ("value", "@value{0.0}")]
MEAN_TIPS = [*TIPS, ("95 %", "@low{0.0} to @high{0.0}")]


def curve_charts(panel: Panel, references: Mapping[str, float], y_returns: Range1d) -> tuple[figure, figure]:
    """Episode return and success rate of one task, as in the paper side by side.

    Args:
        panel: what the algorithms reach in the task.
        references: the paper's success rate after training by algorithm, marked at the right edge.
        y_returns: vertical range of all tasks' returns.
    """
    x_range = Range1d(0.0, _last(panel) * 1.04)
    returns = _sheet(f"{panel.title}: episode return", x_range, y_returns)
    success = _sheet(f"{panel.title}: success rate [%]", x_range, Range1d(-3.0, 104.0))
    for fig, bands, scale in ((returns, panel.returns, 1.0), (success, panel.success, 100.0)):
        drawn = [_draw(fig, band, scale) for band in sorted(bands, key=lambda band: band.algorithm == "submas")]
        fig.add_tools(HoverTool(renderers=[line for line, _ in drawn], tooltips=MEAN_TIPS, visible=False))
        fig.add_tools(HoverTool(renderers=[ends for _, ends in drawn], tooltips=TIPS, visible=False))
        add_csv(fig, fig.title.text.replace(":", "").replace(" ", "-"), *_summaries(fig))  # type: ignore[union-attr]
    _mark(success, references, panel)
    return returns, success


def return_range(panels: Sequence[Panel]) -> Range1d:
    """A vertical range that shows every seed's return in every task."""
    values = [values for panel in panels for band in panel.returns for _, values in band.seeds]
    every = np.concatenate([np.array([-400.0, 500.0]), *values])
    return Range1d(float(every.min()) - 20.0, float(every.max()) + 20.0)


def show_only(charts: Sequence[figure], hidden: Sequence[str]) -> None:
    """Hide these algorithms in all charts, and show the others."""
    for chart in charts:
        for renderer in chart.renderers:
            renderer.visible = renderer.name not in hidden


def _last(panel: Panel) -> float:
    ends = [float(steps[-1]) / MILLION for band in panel.success for steps, _ in band.seeds]
    return max(ends, default=1.0)


def _sheet(title: str, x_range: Range1d, y_range: Range1d) -> figure:
    fig = figure(
        title=title, height=HEIGHT, sizing_mode="stretch_width", tools="xpan,xwheel_zoom,box_zoom,reset,save",
        active_drag=None, x_range=x_range, y_range=y_range, x_axis_label="environment steps of this task [million]",
        min_border_right=14,
    )  # fmt: skip
    plain(fig)
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    return fig


def _draw(fig: figure, band: Band, scale: float) -> tuple[GlyphRenderer, GlyphRenderer]:
    """Every seed thin, the band of the interval, and the summary on top; returns the summary and the seeds' ends."""
    colour, name = ink(band.algorithm), band.algorithm
    ways = {"xs": [steps / MILLION for steps, _ in band.seeds], "ys": [scale * values for _, values in band.seeds]}
    fig.multi_line("xs", "ys", source=ColumnDataSource(ways), color=colour, line_width=1.0, alpha=0.35, name=name)
    ends = fig.scatter("steps", "value", source=_ends(band, scale), color=colour, size=5, alpha=0.6, name=name)
    data = {"steps": band.steps / MILLION, "value": scale * band.value, "low": scale * band.low,
            "high": scale * band.high, "name": [f"{band.label}, interquartile mean"] * len(band.steps)}  # fmt: skip
    summary = ColumnDataSource(data, tags=["summary", band.label])
    known = np.isfinite(band.low)
    if known.any():
        fig.varea(band.steps[known] / MILLION, scale * band.low[known], scale * band.high[known], color=colour,
                  alpha=0.18, name=name)  # fmt: skip
    line = fig.line("steps", "value", source=summary, color=colour, line_width=2.6, line_join="round", name=name)
    if len(band.steps) == 1:  # a single evaluation has no line
        line = fig.scatter("steps", "value", source=summary, color=colour, size=7, name=name)
    return line, ends


def _ends(band: Band, scale: float) -> ColumnDataSource:
    """Where the stage of every seed ended."""
    return ColumnDataSource(
        {
            "steps": [float(steps[-1]) / MILLION for steps, _ in band.seeds],
            "value": [scale * float(values[-1]) for _, values in band.seeds],
            "name": [f"{band.label}, {label}, its last evaluation" for label in band.seed_names],
        }
    )


def _summaries(fig: figure) -> list[ColumnDataSource]:
    """The interquartile means for the CSV, with names of their own."""
    named = []
    for renderer in fig.renderers:
        source = getattr(renderer, "data_source", None)
        if source is not None and "summary" in source.tags and source not in (one for one, _ in named):
            named.append((source, source.tags[1]))
    columns = [
        ColumnDataSource({f"{label} {column}": source.data[column] for column in ("steps", "value", "low", "high")})
        for source, label in named
    ]
    return columns or [ColumnDataSource({"steps": []})]


def _mark(fig: figure, references: Mapping[str, float], panel: Panel) -> None:
    """The paper's numbers as triangles at the right edge."""
    labels = {band.algorithm: band.label for band in panel.success}
    for algorithm, share in references.items():
        if algorithm in labels:
            words = f"the paper's {labels[algorithm]}, best of ten seeds after training (Table 4)"
            source = ColumnDataSource({"x": [_last(panel) * 1.025], "y": [100.0 * share], "name": [words]})
            mark = fig.scatter("x", "y", source=source, marker="inverted_triangle", angle=-np.pi / 2, size=10,
                               color=ink(algorithm), fill_alpha=0.0, line_width=1.8, name=algorithm)  # fmt: skip
            fig.add_tools(HoverTool(renderers=[mark], tooltips=[("", "@name"), ("", "@y{0.0} %")], visible=False))
