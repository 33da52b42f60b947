"""Table 4: the paper's numbers, the best of several seeds, and why that best is not to be trusted."""

from __future__ import annotations

import numpy as np
import pytest

from agents.evaluation import wilson_interval
from tests.workbench.reproduce.samples import made
from workbench.reproduce.paper_numbers import EXPERT_ON_TARGET, TABLE_4
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.table4 import Row, rows, table

PAPER = """
SUBMAS-RL 466.34 94.80, w/oPd 340.65 80.80, w/oPr -59.98 0.00, DecPd 373.49 85.40, DecPr 390.16 86.20,
TD3 64.61 0.00, PPO -310.70 0.00, SAC 77.17 0.00
"""
"""Table 4, copied."""


def row_of(result: ResultSet, variant: str = "submas") -> Row:
    (row,) = [row for row in rows(result) if row.variant == variant]
    return row


def test_the_papers_numbers_are_the_papers() -> None:
    copied = [line.split() for line in PAPER.strip().split(",")]
    assert [(float(line[1]), pytest.approx(float(line[2]) / 100.0)) for line in copied] == list(TABLE_4.values())
    # The interval that 1000 episodes leave of the paper's expert.
    assert wilson_interval(round(1000 * EXPERT_ON_TARGET), 1000) == pytest.approx((0.591, 0.651), abs=5e-4)


def test_the_best_of_all_seeds_is_the_one_with_the_highest_return() -> None:
    result = made("table4", success=lambda variant, task, seed, purpose: 0.9 + 0.01 * (seed == 4))
    assert (row_of(result).best.seed, row_of(result).best.success_rate) == (4, pytest.approx(0.91))


def test_the_seed_chosen_by_other_episodes_is_reported_on_the_reported_ones() -> None:
    def success(variant: str, task: str, seed: int, purpose: str) -> float:
        return {("selection", 2): 0.99, ("report", 2): 0.93, ("report", 7): 0.97}.get((purpose, seed), 0.9)

    row = row_of(made("table4", success=success))
    assert (row.best.seed, row.best.success_rate) == (7, 0.97)
    assert row.chosen is not None
    assert (row.chosen.seed, row.chosen.success_rate, row.chosen.purpose) == (2, 0.93, "report")


def test_without_a_choice_on_all_seeds_nothing_is_chosen() -> None:
    whole = made("table4", seeds=3)
    kept = tuple(n for n in whole.numbers if (n.purpose, n.seed) != ("selection", 1))
    assert row_of(ResultSet(**{**vars(whole), "numbers": kept})).chosen is None


def picked(generator: np.random.Generator, trials: int) -> np.ndarray:
    """Best and chosen success minus the truth, `[trials, 2]`: ten seeds of equal skill, 1000 episodes each."""
    truth, errors = 0.9, []
    for _ in range(trials):
        flown = {p: generator.binomial(1000, truth, 10) / 1000 for p in ("report", "selection")}
        result = made("table4", success=lambda v, t, seed, p, flown=flown: float(flown[p][seed]), without=OTHERS)  # type: ignore[misc]
        row = row_of(result)
        assert row.chosen is not None
        errors.append([row.best.success_rate - truth, row.chosen.success_rate - truth])
    return np.array(errors)


OTHERS = tuple(variant for variant in TABLE_4 if variant != "submas")


def test_the_best_of_ten_seeds_flatters_and_the_chosen_one_does_not() -> None:
    # Ten policies that are equally good: by how much the best of them looks better is the bias. The expected maximum
    # of ten normal draws is 1.54 standard deviations, here of sqrt(0.9 * 0.1 / 1000).
    errors = picked(np.random.default_rng(0), 150)
    spread = np.sqrt(0.9 * 0.1 / 1000)
    standard_error = spread / np.sqrt(len(errors))
    assert errors[:, 0].mean() == pytest.approx(1.54 * spread, abs=4.0 * standard_error)
    assert abs(errors[:, 1].mean()) < 4.0 * standard_error


def test_the_table_says_what_is_not_there() -> None:
    empty = table(None)
    assert [row[0] for row in empty.rows] == ["SubMas-RL", "w/oPd", "w/oPr", "DecPd", "DecPr", "TD3", "PPO", "SAC"]
    assert {row[2] for row in empty.rows} == {"not run yet"}
    partial = table(made("table4", seeds=3, without=("sac",), success=lambda *_: 0.948))
    assert partial.rows[-1][2] == "not run yet"
    first = dict(zip(partial.columns, partial.rows[0], strict=True))
    assert first["paper, best of 10 seeds"] == "466.3, 94.8 %"
    assert first["best of our seeds, as in the paper"] == "453.2, 94.8 % [93.2, 96.0] (seed 0)"
    assert first["all seeds: success"] == "94.8 % [94.8, 94.8]"
    assert first["seeds"] == "3"


def test_a_single_seed_has_no_interval_over_seeds() -> None:
    only = table(made("table4", seeds=1, success=lambda *_: 0.5))
    assert only.rows[0][-2] == "50.0 %"


def test_markdown_has_a_line_for_each_algorithm() -> None:
    lines = table(None).markdown().splitlines()
    assert lines[0] == "**Return and success on the target task**"
    assert len(lines) == 2 + 2 + 8
    assert all(line.count("|") == 8 for line in lines[2:])
