"""Fig. 13: SubMas-RL and the dragging expert on five tasks, bars with Wilson intervals beside the paper's numbers."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Rectangle
from PIL import Image

from layouts.paper_bars import policy_bars
from layouts.paper_inks import ink
from layouts.paper_panels import Bars
from tests.workbench.reproduce.samples import made
from workbench.reproduce.pictures import draw
from workbench.reproduce.scorecard import complete, scorecard

TASKS = ("a", "b", "c")
WIDE = ((0.99, 1.0), (0.98, 1.0), (0.93, 0.96))
SUBMAS = Bars("submas", "SubMas-RL", (300.0, 400.0, 500.0), (1.0, 0.99, 0.948), WIDE)
EXPERT = Bars("expert", "expert", (300.0, 200.0, None), (1.0, 0.8, None), ((0.99, 1.0), (0.77, 0.83), None))


def heights(axes: object, algorithm: str) -> list[float]:
    from matplotlib.colors import to_rgba

    patches = [p for p in axes.patches if isinstance(p, Rectangle)]  # type: ignore[attr-defined]
    return [p.get_height() for p in patches if p.get_facecolor() == to_rgba(ink(algorithm))]


def test_bars_are_the_numbers_on_both_sides() -> None:
    left, right = policy_bars(TASKS, (SUBMAS, EXPERT), None, {}, "caption").axes
    assert heights(left, "submas") == [300.0, 400.0, 500.0]
    assert heights(right, "submas") == [100.0, 99.0, pytest.approx(94.8)]
    assert heights(right, "expert") == [100.0, 80.0, 0.0]
    assert (left.get_ylabel(), right.get_ylabel()) == ("episode return", "success rate [%]")


def test_a_number_that_is_missing_is_named() -> None:
    left, right = policy_bars(TASKS, (SUBMAS, EXPERT), None, {}, "caption").axes
    for axes in (left, right):
        assert [text.get_text() for text in axes.texts].count("not run") == 1


def test_whiskers_are_the_intervals() -> None:
    _, right = policy_bars(TASKS, (EXPERT,), None, {}, "caption").axes
    assert [list(np.asarray(line.get_ydata())) for line in right.lines] == [[99.0, 100.0], [77.0, pytest.approx(83.0)]]


def test_the_papers_number_and_the_other_policy_are_marked() -> None:
    _, right = policy_bars(TASKS, (SUBMAS, EXPERT), SUBMAS, {2: 0.621}, "caption").axes
    marks = [line for line in right.lines if line.get_label() in ("the paper's expert", "SubMas-RL")]
    assert [list(np.asarray(line.get_ydata())) for line in marks] == [
        pytest.approx([100.0, 99.0, 94.8]),
        pytest.approx([62.1, 62.1]),
    ]


def test_blue_and_green_are_the_papers() -> None:
    red, green, blue = (int(ink("submas")[i : i + 2], 16) for i in (1, 3, 5))
    assert blue > max(red, green)
    red, green, blue = (int(ink("expert")[i : i + 2], 16) for i in (1, 3, 5))
    assert green > max(red, blue)


def test_it_is_drawn_from_a_result_set(tmp_path: Path) -> None:
    result = made("fig13", success=lambda variant, *_: 0.621 if variant == "expert" else 0.948)
    assert draw(result, tmp_path / "fig13.png")
    assert Image.open(io.BytesIO((tmp_path / "fig13.png").read_bytes())).size == (1392, 588)
    assert complete(result)
    rows = scorecard("fig13", result).tables[0].rows
    assert (rows[0][0], rows[-1][0]) == ("source task 4", "target task")
    assert rows[-1][2] == "158.9, 62.1 % [59.1, 65.1]"
