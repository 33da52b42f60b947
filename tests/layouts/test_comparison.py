"""Figures of comparisons: where bars stand, how causes stack, where a click on the map leads, what a picture holds."""

from __future__ import annotations

import itertools
import math
from xml.etree import ElementTree

import numpy as np
import pytest

from layouts.comparison_bars import Bar, bar_columns, cause_chart, places, return_chart, success_chart
from layouts.comparison_inks import cause_ink, cause_words, policy_inks
from layouts.comparison_picture import comparison_picture
from layouts.comparison_survival import Shots, cell_columns, survival_chart
from layouts.comparison_thumbnail import Tracks, thumbnail
from layouts.paper_sheet import picture
from layouts.theme import MISSILES, POLICY_A, POLICY_B, missile_colour
from sim.scenario_file import load_scenario

TASKS = ["source-1", "target"]
BARS = [
    Bar("source-1", "A", "#111111", 99.5, 98.8, 99.8, {"shot_down_1": 0.5}, {"shot_down_1": 5}),
    Bar("source-1", "B", "#222222", 84.3, 81.9, 86.4, {"shot_down_1": 4.9, "left_field": 10.8}, {"left_field": 108}),
    Bar("target", "A", "#111111", None),
    Bar("target", "B", "#222222", 61.7, None, None, {"shot_down": 23.8, "left_field": 14.5}, elsewhere=True),
]


def test_bars_of_a_task_stand_side_by_side_around_its_place() -> None:
    placed = places(TASKS, BARS)
    assert [round(x, 2) for x, _, _ in placed] == [-0.21, 0.21, 0.79, 1.21]
    for (x, width, one), (y, _, other) in itertools.pairwise(placed):
        assert x + width < y or one.task != other.task
    assert all(abs(x - TASKS.index(bar.task)) + width / 2 < 0.5 for x, width, bar in placed)


def test_a_bar_without_value_has_its_place_but_is_not_drawn() -> None:
    columns = bar_columns(TASKS, BARS)
    assert columns["value"] == [99.5, 84.3, 61.7] and columns["x"][2] == pytest.approx(1.21)
    assert (columns["low"][2], columns["high"][2]) == (61.7, 61.7)
    assert columns["hatch"] == [" ", " ", "right_diagonal_line"]


def test_causes_stack_to_all_that_was_lost() -> None:
    chart = cause_chart(200)
    chart.show(TASKS, BARS)
    data = chart.source.data
    for policy, task, lost in (("B", "source-1", 15.7), ("B", "target", 38.3), ("A", "source-1", 0.5)):
        bars = zip(data["policy"], data["task"], data["top"], strict=True)
        assert max(top for one, where, top in bars if (one, where) == (policy, task)) == pytest.approx(lost)
    assert data["colour"][0] == missile_colour(1)
    assert chart.figure.y_range.end > 38.3


def test_scales_hold_every_interval_and_success_always_the_same() -> None:
    returns, success = return_chart(200), success_chart(200)
    returns.show(TASKS, [Bar("target", "A", "#111111", -380.0, -400.0, -360.0)])
    success.show(TASKS, BARS)
    assert returns.figure.y_range.start < -400.0 and returns.figure.y_range.end >= 1.0
    assert success.figure.y_range.end > 100.0
    assert success.figure.xaxis[0].major_label_overrides == {0: "source-1", 1: "target"}


def test_the_two_first_policies_keep_their_inks_and_others_differ() -> None:
    names = ["run-1", "submas-target", "run-2", "expert-dragging", "run-3"]
    inks = policy_inks(names)
    assert (inks["submas-target"], inks["expert-dragging"]) == (POLICY_A, POLICY_B)
    assert len(set(inks.values())) == 5 and not set(inks.values()) & set(MISSILES[:4])


def test_causes_have_the_missile_s_ink_and_plain_words() -> None:
    assert cause_ink("shot_down_3") == missile_colour(3) and cause_words("shot_down_3") == "shot down by missile 3"
    assert cause_words("left_field") == "left the field"


SHOTS = Shots(
    np.array([10e3, 20e3]), np.array([-180.0, -90.0, 0.0, 90.0]),
    np.array([[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.5]]), np.array([[5.0, 5.0, 5.0, 5.0], [900.0, 3.0, 3.0, np.nan]]),
)  # fmt: skip


def test_the_nose_is_up_and_left_is_left() -> None:
    columns = cell_columns(SHOTS)
    middle = [(a + b) / 2 for a, b in zip(columns["start"], columns["end"], strict=True)]
    for aspect, angle in zip(columns["aspect_deg"], middle, strict=True):
        x, y = math.cos(angle), math.sin(angle)
        assert (x, y) == pytest.approx((-math.sin(math.radians(aspect)), math.cos(math.radians(aspect))), abs=1e-9)
    assert min(columns["inner"]) >= 0.0 and columns["outer"][0] == columns["inner"][4] == 15.0


def test_cells_say_what_became_of_the_shot() -> None:
    words = cell_columns(SHOTS)["words"]
    assert words[0].startswith("10.0 km, behind: shot down")
    assert words[4].startswith("20.0 km, behind: survived, missed by 900 m")
    assert words[7].startswith("20.0 km, 90° left: survived 50 %")


def test_a_map_leads_to_its_address_and_forgets_it() -> None:
    chart = survival_chart("first", 200)
    chart.show(SHOTS, "here", "/fly?a=x")
    assert chart.figure.tags == ["/fly?a=x"] and len(chart.source.data["survived"]) == 8
    chart.clear("nothing")
    assert chart.figure.tags == [] and len(chart.source.data["survived"]) == 0


def test_a_small_picture_is_svg_with_everything_that_flew() -> None:
    tracks = Tracks(
        [[-100.0, 10.0], [0.0, 0.0]], [[100.0, 0.0], [50.0, 0.0]], {2: [[40.0, 0.0], [0.0, 0.0]]}, frozenset({2})
    )
    root = ElementTree.fromstring(thumbnail(load_scenario("default").battlefield, tracks, POLICY_A, "words"))
    assert root.get("aria-label") == "words"
    lines = {line.get("stroke"): line.get("points") for line in root.iter("polyline")}
    assert lines[POLICY_A] == "-100.00,-10.00 0.00,-0.00"  # y up
    assert missile_colour(2) in lines and len(lines) == 3
    left, _, width, height = (float(value) for value in root.get("viewBox", "").split())
    assert left < -110.0 and width > 220.0 and height > 76.0


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_the_sheet_is_a_picture_and_always_the_same(kind: str) -> None:
    def drawn() -> bytes:
        return picture(comparison_picture(TASKS, BARS, BARS, "caption"), kind)  # type: ignore[arg-type]

    assert drawn() == drawn()
