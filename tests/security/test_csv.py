"""S9: no cell of a CSV is worked out by the spreadsheet that opens it, and every cell is one cell."""

from __future__ import annotations

import csv
import dataclasses
import io

import numpy as np
import pytest
from bokeh.models import CustomAction
from bokeh.plotting import figure

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation
from layouts.figure_downloads import add_downloads
from tests.security.hostile import EVERY
from workbench.comparison.tables import engagements_table, pairs_table
from workbench.csv_cells import FORMULA_STARTS, plain_cell
from workbench.reproduce.number_csv import COLUMNS, csv_text
from workbench.reproduce.result_set import Number, ResultSet

NAMES = EVERY


def cells(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text, newline="")))


def assert_plain(text: str, width: int) -> None:
    rows = cells(text)
    assert {len(row) for row in rows} == {width}
    for cell in (cell for row in rows for cell in row):
        number = cell.lstrip("+-").replace(".", "").replace("e", "").replace("-", "").isdigit()
        assert number or not cell.startswith(FORMULA_STARTS), cell


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_a_name_stays_a_text(name: str) -> None:
    cell = plain_cell(name)
    assert cell.isprintable() and not cell.startswith(FORMULA_STARTS)
    if name.isprintable():
        assert cell.removeprefix("'") == name.removeprefix("'")


@pytest.mark.parametrize("number", [-3, -2.5, 0, 1e-9, None, True])
def test_a_number_stays_a_number(number: object) -> None:
    assert plain_cell(number) is number


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_the_tables_of_a_comparison(name: str) -> None:
    results = EpisodeResults(
        episode=np.arange(2), outcome=np.ones(2, int), killer=np.zeros(2, int), steps=np.ones(2, int),
        solved=np.zeros(2, int), episode_return=np.array([-1.0, 2.0], np.float32), closest_m=np.ones(2, np.float32),
    )  # fmt: skip
    blank = {field.name: None for field in dataclasses.fields(Evaluation)}
    evaluation = Evaluation(**{**blank, "policy": name, "mask": (), "scenario": name, "seed": 1, "results": results})
    assert_plain(engagements_table([evaluation]), 11)
    assert pairs_table(name, name, {}) == ""


@pytest.mark.parametrize("name", NAMES, ids=range(len(NAMES)))
def test_the_numbers_of_a_result_set(name: str) -> None:
    blank = {field.name: name for field in dataclasses.fields(Number)}
    number = Number(**{**blank, "success_ci95": (0.1, 0.2)})
    fields = {field.name: () for field in dataclasses.fields(ResultSet)}
    result = ResultSet(**{**fields, "item": "table4", "numbers": (number,)})
    assert_plain(csv_text(result), len(COLUMNS))


def test_what_a_figure_saves_in_the_browser_has_the_same_rule() -> None:
    fig = figure()
    add_downloads(fig, "figure")
    code = next(
        tool.callback.code for tool in fig.tools if isinstance(tool, CustomAction) and "CSV" in tool.description
    )
    assert """typeof v === "string" && /^[=+\\-@\\t\\r\\n＝＋－＠]/.test(v) ? "'" + v""" in code
