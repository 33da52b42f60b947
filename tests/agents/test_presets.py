"""Every shipped scenario is an engagement worth flying, and docs/scenarios.md tells how hard it is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from agents.evaluation import evaluate
from agents.expert import DraggingExpert, NavigationExpert
from sim.scenario_file import load_scenario, scenario_names
from sim.task import Task

PAGE = (Path(__file__).parents[2] / "docs/scenarios.md").read_text(encoding="utf-8")


def _ladders(name: str) -> dict[str, list[float]]:
    """Success in % by number of missiles, as the page prints it, of both experts."""
    rows = re.search(rf"^\| `{name}` \| (navigation .*)\n\| \| (dragging .*)$", PAGE, re.MULTILINE)
    assert rows, f"docs/scenarios.md has no ladder of {name}"
    cells = [[cell.strip() for cell in row.split("|")] for row in rows.groups()]
    return {expert: [float(cell) for cell in figures if cell] for expert, *figures in cells}


@pytest.mark.parametrize("name", scenario_names())
def test_without_missiles_everybody_arrives_and_with_all_of_them_nobody_who_ignores_them(name: str) -> None:
    target = Task(load_scenario(name))
    assert evaluate(NavigationExpert(), target.mask(target.missiles), 40, 3).success_rate >= 0.99
    assert evaluate(NavigationExpert(), target, 40, 3).success_rate <= 0.05


@pytest.mark.parametrize("name", scenario_names())
def test_a_preset_is_called_as_its_file_and_has_a_graded_ladder(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    ladders = _ladders(name)
    for figures in ladders.values():
        assert len(figures) == scenario.launch.missiles + 1
        assert figures == sorted(figures, reverse=True)
    drops = [harder - easier for easier, harder in zip(ladders["dragging"][1:], ladders["dragging"], strict=False)]
    assert max(drops) < 30.0  # no cliff
    assert 20.0 <= ladders["dragging"][-1] <= 65.0


@pytest.mark.parametrize("name", ["short-range", "six-missiles"])
def test_the_page_tells_what_its_command_gives(name: str) -> None:
    told = _ladders(name)["dragging"][-1]
    measured = 100 * evaluate(DraggingExpert(), Task(load_scenario(name)), 200, seed=0).success_rate
    # Other processors round differently; a few engagements of 200 may then end otherwise.
    assert measured == pytest.approx(told, abs=3.0)


def test_the_default_scenario_is_the_one_the_shipped_policies_know() -> None:
    assert load_scenario().digest == "9c5b275eac5a"
