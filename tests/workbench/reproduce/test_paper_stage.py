"""The one stage with the paper's own settings: what docs/reproduction.md says is what its files hold."""

from __future__ import annotations

import csv
import json
import re

import pytest

from agents.checkpoint import load_policy
from agents.evaluation import evaluate
from layouts.stage_sheet import picture
from sim.task import task_for
from workbench.reproduce.places import ROOT
from workbench.reproduce.protocol import EPISODES, REPORT_SEED

PLACE = ROOT / "assets/paper-stage"
TEXT = (ROOT / "docs/reproduction.md").read_text("utf-8").partition("## One stage with")[2].partition("\n## ")[0]
CARD = json.loads((PLACE / "target.json").read_text("utf-8"))
LATE = 200
"""Epochs before those that the page sums up."""


@pytest.fixture
def curve() -> list[dict[str, float]]:
    with (PLACE / "curve.csv").open(encoding="utf-8") as file:
        return [{name: float(value) for name, value in row.items() if value} for row in csv.DictReader(file)]


def test_the_policy_flies_as_the_page_says() -> None:
    found = evaluate(load_policy(PLACE / "target.safetensors"), task_for(), EPISODES, REPORT_SEED)
    success, value = re.findall(r"Success ([\d.]+) % .*?mean return ([\d.]+)", TEXT)[0]
    assert 100 * found.success_rate == pytest.approx(float(success), abs=0.3)
    assert found.mean_return == pytest.approx(float(value), abs=1.5)


def test_the_command_of_its_card_is_that_of_the_page() -> None:
    assert (CARD["profile"], CARD["seed"], CARD["missiles"]) == ("paper", 0, [1, 2, 3, 4])
    assert "workbench train --missiles 4 --profile paper --seeds 0 " in TEXT
    assert f"{100 * CARD['evaluation']['success_rate']:.1f} % in the 1000 others" in TEXT
    assert f"epoch {CARD['epoch']}" in TEXT


def test_the_curve_is_the_one_that_the_page_tells_of(curve: list[dict[str, float]]) -> None:
    success = [row["success_rate"] for row in curve]
    late = success[LATE:]
    assert [row["epoch"] for row in curve] == list(range(1, 301))
    assert max(success) == success[CARD["epoch"] - 1]
    assert f"{100 * sum(late) / len(late):.0f} % of their held-out episodes on average" in TEXT
    assert (late.count(0.0), sum(0.0 < rate < 0.6 for rate in late), success[-1]) == (1, 6, 0.93)
    assert f"{curve[-1]['cpu_s'] / 3600:.1f} hours of one core** ({curve[-1]['wall_s'] / 3600:.1f} hours" in TEXT


def test_equal_numbers_give_equal_pictures() -> None:
    one, same, other = (picture("a", "b", [0.1, last], [0.8, 0.7], 2) for last in (0.9, 0.9, 0.5))
    assert one == same != other
