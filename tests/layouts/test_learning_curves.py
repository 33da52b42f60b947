"""Learning curves grow in place: only what is new is sent, a long run stays light, zooming by hand is left alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from layouts.chart import Columns
from layouts.learning_curves import MAX_POINTS, RAW, LearningCurves, RunLearning
from layouts.learning_panels import PANELS

CURVES = [curve for panel in PANELS for curve in panel.curves]
NO_STAGES: Columns = {"x": np.empty(0), "task": np.empty(0, object)}


def _columns(count: int, held_out: bool) -> Columns:
    columns: Columns = {"x": np.arange(1.0, count + 1.0), "run": np.full(count, "a", object)}
    for curve in CURVES:
        if curve.held_out == held_out:
            columns[curve.name] = columns[curve.name + RAW] = np.linspace(0.0, 400.0, count)
    return columns


def _run(count: int, key: str = "a") -> RunLearning:
    return RunLearning((key,), _columns(count, held_out=False), _columns(count // 2, held_out=True))


def _shown(curves: LearningCurves, place: int = 0) -> Any:
    return curves._slots[place].epochs.source.data


def test_a_run_that_goes_on_is_only_added_to() -> None:
    curves = LearningCurves()
    curves.show([_run(5)], NO_STAGES, "epoch", smooth=False)
    before = _shown(curves)
    curves.show([_run(9)], NO_STAGES, "epoch", smooth=False)
    assert _shown(curves) is before
    assert list(before["x"]) == list(range(1, 10))
    curves.show([_run(9, key="b")], NO_STAGES, "epoch", smooth=False)
    assert _shown(curves) is not before


def test_a_run_that_was_cut_back_is_drawn_anew() -> None:
    curves = LearningCurves()
    for count in (9, 4):
        curves.show([_run(count)], NO_STAGES, "epoch", smooth=False)
    assert list(_shown(curves)["x"]) == [1, 2, 3, 4]


def test_a_long_run_stays_light_and_even() -> None:
    curves = LearningCurves()
    for count in (MAX_POINTS - 1, 3 * MAX_POINTS - 1, 3 * MAX_POINTS, 3 * MAX_POINTS + 7):
        curves.show([_run(count)], NO_STAGES, "epoch", smooth=False)
    shown = np.asarray(_shown(curves)["x"])
    assert len(shown) <= MAX_POINTS
    assert set(np.diff(shown)) == {4.0}


def test_one_run_has_inks_by_curve_and_several_by_run() -> None:
    curves = LearningCurves()
    curves.show([_run(5)], NO_STAGES, "epoch", smooth=False)
    inks = {renderer.glyph.line_color for _, _, renderer in curves._slots[0].lines}
    assert {curve.ink for curve in CURVES} == inks
    curves.show([_run(5), _run(5, key="b")], NO_STAGES, "epoch", smooth=False)
    each = [{renderer.glyph.line_color for _, _, renderer in slot.lines} for slot in curves._slots]
    assert [len(inks) for inks in each] == [1, 1]
    assert each[0] != each[1]
    curves.show([_run(5)], NO_STAGES, "epoch", smooth=False)
    assert not len(_shown(curves, 1)["x"])


def test_axes_follow_until_somebody_zooms_and_again_after_a_reset() -> None:
    curves = LearningCurves()
    x = curves._x_range.range
    assert all(fig.x_range is x for fig in curves.figures.values())
    curves.show([_run(10)], NO_STAGES, "epoch", smooth=False)
    assert x.end == 10.2
    x.update(start=2.0, end=4.0)
    curves.show([_run(20)], NO_STAGES, "epoch", smooth=False)
    assert (x.start, x.end) == (2.0, 4.0)
    x.update(start=x.reset_start, end=x.reset_end)
    curves.show([_run(30)], NO_STAGES, "epoch", smooth=False)
    assert x.end == 30.6


def test_what_is_hidden_stays_hidden_and_leaves_the_axis() -> None:
    curves = LearningCurves()
    run = _run(10)
    run.epochs["train_return_mean"] = np.full(10, 9000.0)
    tops = []
    for hidden in ([], ["train_return_mean"]):
        curves.hide(hidden)
        curves.show([run], NO_STAGES, "epoch", smooth=True)
        framed = curves._y_ranges["return"].framed
        assert framed is not None
        tops.append(framed[1])
    assert tops[0] > 9000.0 > 500.0 > tops[1]
    seen = [r.visible for _, curve, r in curves._slots[0].lines if curve.name == "train_return_mean"]
    assert seen == [False]


def test_a_download_has_the_numbers_of_every_run() -> None:
    curves = LearningCurves()
    curves.show([_run(5), _run(5, key="b")], NO_STAGES, "epoch", smooth=False)
    assert len(curves._csv["success"].args["sources"]) == 4
    assert len(curves._csv["q"].args["sources"]) == 2
