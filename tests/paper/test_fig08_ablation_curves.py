"""Fig. 8: return and success of five algorithms in four tasks while they learn, with every seed in sight."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from layouts.paper_curves import ablation_figure
from layouts.paper_inks import ink
from layouts.paper_panels import Band, Panel
from layouts.paper_sheet import picture
from tests.workbench.reproduce.samples import made
from workbench.reproduce.pictures import draw, source_of

TASKS = ("source task 3", "source task 2", "source task 1", "target task")


def band(algorithm: str, value: float, seeds: int = 3) -> Band:
    steps = np.array([1e5, 2e5, 3e5])
    runs = tuple((steps[: seed + 1], np.full(seed + 1, value + 0.01 * seed)) for seed in range(seeds))
    flat = np.full(3, value)
    return Band(algorithm, algorithm.upper(), steps, flat, flat - 0.1, flat + 0.1, runs)


def panels() -> list[Panel]:
    return [
        Panel(task, (band("submas", 450.0), band("wo-pd", 300.0)), (band("submas", 0.9), band("wo-pd", 0.6)))
        for task in TASKS
    ]


def lines_of(axes: Axes, algorithm: str) -> list[Line2D]:
    return [line for line in axes.lines if line.get_color() == ink(algorithm)]


def test_each_task_has_a_panel_of_return_and_one_of_success() -> None:
    axes = ablation_figure(panels(), "caption").axes
    assert [one.get_title(loc="left") for one in axes[::2]] == list(TASKS)
    assert (axes[0].get_ylabel(), axes[1].get_ylabel()) == ("episode return", "success rate")
    assert all(one.get_xlabel() == "environment steps [million]" for one in axes[1::2])


def test_every_seed_is_drawn_under_the_summary() -> None:
    axes = ablation_figure(panels(), "caption").axes[1]
    drawn = lines_of(axes, "submas")
    thick = [line for line in drawn if line.get_linewidth() == 2.0]
    thin = [line for line in drawn if line.get_linewidth() == 0.6]
    assert [list(np.asarray(line.get_ydata())) for line in thick] == [[0.9, 0.9, 0.9]]
    assert sorted(len(np.asarray(line.get_xdata())) for line in thin) == [1, 2, 3]
    assert float(np.asarray(thick[0].get_xdata())[-1]) == 0.3
    # SubMas-RL lies on top.
    assert axes.lines[-1] is thick[0]


def test_the_band_is_the_interval() -> None:
    axes = ablation_figure(panels(), "caption").axes[1]
    extents = [(c.get_paths()[0].vertices[:, 1].min(), c.get_paths()[0].vertices[:, 1].max()) for c in axes.collections]  # type: ignore[union-attr]
    assert extents == [pytest.approx((0.5, 0.7)), pytest.approx((0.8, 1.0))]


def test_one_seed_has_no_band_and_no_seed_says_so() -> None:
    nothing = np.full(3, np.nan)
    single = Band("submas", "SubMas-RL", np.arange(3.0), np.zeros(3), nothing, nothing, ())
    figure = ablation_figure([Panel("target task", (single,), (single,)), Panel("source task 1", (), ())], "caption")
    assert not figure.axes[0].collections
    assert [text.get_text() for text in figure.axes[2].texts] == ["not run yet"]


def texts(figure: Figure) -> str:
    return " ".join(text.get_text() for text in figure.texts)


def test_a_full_picture_is_small_and_says_what_it_was_drawn_from(tmp_path: Path) -> None:
    result = made("fig8", seeds=10, points=16, success=lambda v, t, seed, p: 0.5 + 0.04 * seed)
    assert draw(result, tmp_path / "fig8.png")
    content = (tmp_path / "fig8.png").read_bytes()
    assert len(content) < 200_000
    image = Image.open(io.BytesIO(content))
    assert image.size == (1632, 792)
    assert image.info["Description"] == source_of(result)
    assert source_of(made("fig8", seeds=9)) != source_of(result)


def test_equal_figures_give_equal_bytes() -> None:
    first, *_ = panels()
    one, other = (picture(ablation_figure([first], "caption"), "png", "a") for _ in range(2))
    assert one == other
    assert picture(ablation_figure([first], "another caption"), "png", "a") != one
    assert picture(ablation_figure([first], "caption"), "svg", "a").startswith(b"<?xml")


def test_without_curves_there_is_no_picture(tmp_path: Path) -> None:
    assert not draw(made("fig8", seeds=0), tmp_path / "fig8.png")
    assert not draw(made("table4", seeds=2), tmp_path / "table4.png")
    assert not list(tmp_path.iterdir())
