"""Fig. 13 to point at: return and success of two policies on the tasks of the chain, as bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bokeh.models import ColumnDataSource, FixedTicker, HoverTool, Range1d
from bokeh.plotting import figure

from layouts.chart import add_csv, plain
from layouts.paper_inks import ink
from layouts.paper_panels import WIDTH, Bars
from layouts.theme import NEUTRAL

HEIGHT = 320
HIGHEST = 108.0


def bar_charts(
    tasks: Sequence[str], bars: Sequence[Bars], dots: Bars, references: Mapping[int, float]
) -> tuple[figure, figure]:
    """Episode return and success rate by task; whiskers are 95 % intervals, triangles the paper's success rates.

    Args:
        tasks: their names, one for each group of bars.
        bars: policies side by side.
        dots: another policy, a diamond in the middle of each group.
        references: the paper's success rates by position of the task.
    """
    every = [value for one in (*bars, dots) for value in one.returns if value is not None]
    low, high = min([0.0, *every]), max([0.0, *every]) or 1.0
    returns = _sheet("episode return", tasks, Range1d(1.12 * low, 1.12 * high))
    success = _sheet("success rate [%]", tasks, Range1d(0.0, HIGHEST))
    for position, one in enumerate(bars):
        shift = (position - (len(bars) - 1) / 2.0) * (WIDTH + 0.02)
        _bars(returns, tasks, one, one.returns, shift)
        _bars(success, tasks, one, _percent(one.success), shift, whiskers=True)
    _dots(returns, tasks, dots, dots.returns)
    _dots(success, tasks, dots, _percent(dots.success))
    if references:
        _references(success, references)
    return returns, success


def _percent(shares: Sequence[float | None]) -> list[float | None]:
    return [None if share is None else 100.0 * share for share in shares]


def _sheet(title: str, tasks: Sequence[str], y_range: Range1d) -> figure:
    fig = figure(
        title=title, height=HEIGHT, sizing_mode="stretch_width", tools="save", active_drag=None, y_range=y_range,
        x_range=Range1d(-0.6, len(tasks) - 0.4), min_border_right=10,
    )  # fmt: skip
    plain(fig)
    fig.background_fill_alpha = fig.border_fill_alpha = 0.0
    fig.xaxis.ticker = FixedTicker(ticks=list(range(len(tasks))))
    fig.xaxis.major_label_overrides = {place: task.replace(" task", "\ntask") for place, task in enumerate(tasks)}
    fig.xgrid.grid_line_alpha = 0.0
    return fig


def _bars(
    fig: figure, tasks: Sequence[str], one: Bars, values: Sequence[float | None], shift: float, whiskers: bool = False
) -> None:
    rows = [(place, value) for place, value in enumerate(values) if value is not None]
    interval = [one.interval[place] or (float("nan"), float("nan")) for place, _ in rows]
    source = ColumnDataSource(
        {
            "task": [tasks[place] for place, _ in rows],
            "policy": [one.label] * len(rows),
            "value": [value for _, value in rows],
            "x": [place + shift for place, _ in rows],
            "low": [100.0 * low for low, _ in interval],
            "high": [100.0 * high for _, high in interval],
        }
    )
    drawn = fig.vbar("x", WIDTH, "value", source=source, color=ink(one.algorithm), fill_alpha=0.85, name=one.algorithm)
    tips = [("", "@policy, @task"), ("", "@value{0.0}"), *([("95 %", "@low{0.0} to @high{0.0}")] if whiskers else [])]
    fig.add_tools(HoverTool(renderers=[drawn], tooltips=tips, visible=False))
    if whiskers:
        fig.segment("x", "low", "x", "high", source=source, color="white", line_width=4.0)
        fig.segment("x", "low", "x", "high", source=source, color="black", line_width=1.8)
    add_csv(fig, f"fig13-{one.algorithm}", source)


def _dots(fig: figure, tasks: Sequence[str], one: Bars, values: Sequence[float | None]) -> None:
    rows = [(place, value) for place, value in enumerate(values) if value is not None]
    names = [f"{one.label}, {tasks[place]}" for place, _ in rows]
    source = ColumnDataSource({"x": [p for p, _ in rows], "value": [v for _, v in rows], "name": names})
    drawn = fig.scatter("x", "value", source=source, marker="diamond", size=14, fill_color="white", line_color="black",
                        name=one.algorithm)  # fmt: skip
    fig.add_tools(HoverTool(renderers=[drawn], tooltips=[("", "@name"), ("", "@value{0.0}")], visible=False))


def _references(fig: figure, references: Mapping[int, float]) -> None:
    source = ColumnDataSource({"x": [p + 0.47 for p in references], "value": [100.0 * s for s in references.values()]})
    drawn = fig.scatter("x", "value", source=source, marker="inverted_triangle", angle=1.5708, size=13, color=NEUTRAL,
                        name="paper")  # fmt: skip
    fig.add_tools(HoverTool(renderers=[drawn], tooltips=[("", "the paper's expert"), ("", "@value{0.0} %")],
                            visible=False))  # fmt: skip
