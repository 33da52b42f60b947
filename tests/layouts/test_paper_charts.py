"""Charts of the Paper page: every seed is there, the paper's numbers stand where they belong, what wraps is broken."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import GlyphRenderer
from bokeh.plotting import figure

from layouts.paper_azimuth_charts import azimuth_chart
from layouts.paper_bar_charts import bar_charts
from layouts.paper_curve_charts import curve_charts, return_range, show_only
from layouts.paper_dot_charts import DotRow, dot_chart
from layouts.paper_map import MapTrack, map_picture
from layouts.paper_panels import AzimuthPanel, Band, Bars, Panel
from layouts.theme import missile_colour

STEPS = np.array([1e6, 2e6])


def band(algorithm: str, seeds: int, value: float, known: bool = True) -> Band:
    line = np.full(2, value)
    bound = line if known else np.full(2, np.nan)
    names = tuple(f"seed {seed}" for seed in range(seeds))
    return Band(algorithm, algorithm.upper(), STEPS, line, bound, bound, tuple([(STEPS, line)] * seeds), names)


def glyphs(fig: figure, kind: str) -> list[GlyphRenderer]:
    return [renderer for renderer in fig.renderers if type(renderer.glyph).__name__ == kind]


def test_curves_show_every_seed_in_percent_and_million_steps() -> None:
    panel = Panel(
        "target task", (band("submas", 3, 450.0),), (band("submas", 3, 0.9), band("wo-pd", 2, 0.5, known=False))
    )
    returns, success = curve_charts(panel, {"submas": 0.948, "sac": 0.0}, return_range([panel]))
    assert sorted(len(one.data_source.data["xs"]) for one in glyphs(success, "MultiLine")) == [2, 3]
    assert {float(line.data_source.data["value"][0]) for line in glyphs(success, "Line")} == {50.0, 90.0}
    assert list(glyphs(success, "Line")[0].data_source.data["steps"]) == [1.0, 2.0]
    assert len(glyphs(success, "VArea")) == 1  # no band where there is no interval
    # The paper's number of an algorithm that is drawn; SAC is not.
    marks = [one for one in glyphs(success, "Scatter") if one.glyph.marker == "inverted_triangle"]
    assert [list(one.data_source.data["y"]) for one in marks] == [[pytest.approx(94.8)]]
    assert returns.y_range.end > 450.0


def test_an_algorithm_is_hidden_in_all_charts_at_once() -> None:
    panel = Panel("target task", (band("submas", 1, 450.0), band("wo-pd", 1, 0.0)), (band("wo-pd", 1, 0.5),))
    charts = curve_charts(panel, {}, return_range([panel]))
    show_only(charts, ["wo-pd"])
    seen = {(one.name, one.visible) for chart in charts for one in chart.renderers}
    assert seen == {("submas", True), ("wo-pd", False)}
    show_only(charts, [])
    assert all(one.visible for chart in charts for one in chart.renderers)


def row(algorithm: str, values: list[float], paper: float) -> DotRow:
    middle = float(np.mean(values)) if values else None
    names, keys = [f"{algorithm} {index}" for index in range(len(values))], [f"{algorithm}.{v}" for v in values]
    best = int(np.argmax(values)) if values else None
    return DotRow(algorithm, algorithm, values, names, keys, best, middle, np.nan, np.nan, paper)


def test_every_seed_is_a_dot_and_the_best_has_a_ring() -> None:
    _, dots = dot_chart("success", [row("submas", [90.0, 97.0, 95.0], 94.8), row("sac", [], 0.0)], (0.0, 100.0))
    assert dots.data["value"] == [90.0, 97.0, 95.0]
    assert dots.data["key"] == ["submas.90.0", "submas.97.0", "submas.95.0"]
    assert int(np.argmax(dots.data["ring"])) == 1
    assert len(set(dots.data["row"])) == 3  # none hides another
    assert max(abs(float(place)) for place in dots.data["row"]) < 0.5


def test_the_papers_numbers_are_there_without_any_seed_of_ours() -> None:
    chart, dots = dot_chart("success", [row("submas", [], 94.8), row("sac", [], 0.0)], (0.0, 100.0))
    (mark,) = [one for one in chart.renderers if one.name == "paper"]
    assert mark.data_source.data["value"] == [94.8, 0.0]
    assert dots.data["value"] == []


def test_bars_that_are_not_flown_are_left_out() -> None:
    bars = Bars("submas", "SubMas-RL", [400.0, None], [0.9, None], [(0.88, 0.92), None])
    returns, success = bar_charts(["source task 1", "target task"], [bars], bars, {1: 0.621})
    assert glyphs(success, "VBar")[0].data_source.data["value"] == [90.0]
    assert glyphs(success, "VBar")[0].data_source.data["high"] == [92.0]
    assert glyphs(returns, "VBar")[0].data_source.data["value"] == [400.0]
    (reference,) = [one for one in success.renderers if one.name == "paper"]
    assert reference.data_source.data["value"] == [pytest.approx(62.1)]


def test_an_azimuth_that_wraps_is_broken() -> None:
    panel = AzimuthPanel("(a)", np.arange(3.0), {1: np.array([170.0, -170.0, -160.0])})
    chart = azimuth_chart(panel)
    (line,) = glyphs(chart, "Line")
    drawn = line.data_source.data["missile_1_deg"]
    assert len(drawn) == 4 and np.isnan(drawn[1])
    assert line.glyph.line_color == missile_colour(1)


def test_a_map_points_up_where_the_world_does() -> None:
    tracks = [
        MapTrack("evader", "#2f86ff", [(-100.0, 0.0), (50.0, 20.0)]),
        MapTrack("m", "#123456", [(0.0, 0.0)], ended=True),
    ]
    picture = map_picture("(a) title", (220.0, 76.0), (0.0, 5.0), tracks)
    assert 'points="-100.00,-0.00 50.00,-20.00"' in picture
    assert 'aria-label="(a) title"' in picture
    assert picture.count('fill="none"') == 2  # the whole, and the end of what has ended
