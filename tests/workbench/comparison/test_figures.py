"""Figures of comparisons: causes, the shipped set, pairs against numbers by hand, the gallery."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation, wilson_interval
from sim.task import Task, task_for
from workbench.comparison.figures import flown_figures, shipped_figures, shipped_set
from workbench.comparison.gallery import SHOWN, strips
from workbench.comparison.pairs import episodes_won_alone, mcnemar, paired
from workbench.comparison.policies import entry
from workbench.comparison.work import ComparisonError, Work
from workbench.runs import RunStore

SEED = 2**46
ONE_MISSILE = task_for("default", "2,3,4")
PATIENCE_S = 300.0


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


def _work(store: RunStore, policy: str = "expert-dragging", task: Task = ONE_MISSILE, episodes: int = 20) -> Work:
    return entry(policy, task, store).work("evaluation", "default", task, SEED, episodes=episodes)


def _made(won: list[int], returns: list[float], killers: list[int] | None = None) -> Evaluation:
    """An evaluation with these outcomes; what was lost was shot down by these missiles."""
    count = len(won)
    killer = np.array(killers or [0] * count)
    outcome = np.where(np.array(won) == 1, 1, np.where(killer > 0, 2, 3))
    results = EpisodeResults(
        np.arange(count), outcome, killer, np.array(returns, np.float32), np.full(count, 9), np.zeros(count, int),
        np.linspace(20.0, 90.0, count, dtype=np.float32),
    )  # fmt: skip
    wins = sum(won)
    return Evaluation(
        "made", (), (1, 2, 3, 4), "default", count, SEED, wins / count, wilson_interval(wins, count),
        float(np.mean(returns)), 9.0, {"exit": wins, "shot_down": int((outcome == 2).sum()),
        "left_field": int((outcome == 3).sum()), "timeout": 0, "not_finite": 0}, 0.0, 1.0, results,
    )  # fmt: skip


def test_pairs_of_a_hand_made_table() -> None:
    a = _made([1, 1, 1, 1, 0, 0], [5, 5, 5, 5, 1, 1])
    b = _made([1, 0, 0, 0, 1, 0], [5, 1, 1, 1, 5, 1])
    figures = paired(a, b)
    assert (figures.both, figures.only_a, figures.only_b, figures.neither, figures.episodes) == (1, 3, 1, 1, 6)
    assert figures.success_difference[0] == pytest.approx(2 / 6)
    assert figures.return_difference[0] == pytest.approx(8 / 6)
    low, high = figures.success_difference[1:]
    assert low < 2 / 6 < high
    assert figures.p_value == pytest.approx(10 / 16)
    assert episodes_won_alone(a, b).tolist() == [1, 2, 3] and episodes_won_alone(b, a).tolist() == [4]


@pytest.mark.parametrize(("only_a", "only_b", "p"), [(0, 0, 1.0), (1, 0, 1.0), (5, 0, 0.0625), (8, 2, 0.109375)])
def test_exact_mcnemar(only_a: int, only_b: int, p: float) -> None:
    assert mcnemar(only_a, only_b) == mcnemar(only_b, only_a) == pytest.approx(p)


def test_a_paired_interval_is_narrower_than_an_unpaired_one() -> None:
    generator = np.random.default_rng(0)
    easy = generator.random(1000)
    a, b = ([int(share > bar) for share in easy] for bar in (0.30, 0.35))
    _, low, high = paired(_made(a, [0.0] * 1000), _made(b, [0.0] * 1000)).success_difference
    unpaired = 2 * 1.96 * np.sqrt(0.7 * 0.3 / 1000 + 0.65 * 0.35 / 1000)
    assert high - low < 0.5 * unpaired and low > 0.0


def test_policies_that_flew_other_engagements_are_not_paired() -> None:
    with pytest.raises(ComparisonError, match="did not fly the same"):
        paired(_made([1, 0], [1, 0]), _made([1, 0, 1], [1, 0, 1]))


def test_the_gallery_has_the_closest_calls_and_every_kind_of_failure() -> None:
    won = [1] * 10 + [0, 0, 0]
    shown = {
        s.kind: s
        for s in strips(_made(won, [0.0] * 13, [0] * 10 + [2, 2, 0]), _made([1] * 9 + [0] * 3 + [1], [0.0] * 13), "B")
    }
    assert set(shown) == {"closest", "won_alone", "lost_alone", "shot_down_2", "left_field"}
    assert shown["closest"].count == 10 and shown["closest"].episodes == tuple(range(SHOWN))
    assert shown["won_alone"].episodes == (9,) and shown["lost_alone"].episodes == (12,)
    assert shown["shot_down_2"].episodes == (10, 11) and shown["left_field"].episodes == (12,)
    assert "B" in shown["won_alone"].title


def test_figures_of_a_flown_evaluation(store: RunStore) -> None:
    evaluation = _made([1, 0, 0, 0], [4.0, 2.0, 2.0, 0.0], [0, 3, 3, 0])
    figures = flown_figures(evaluation, _work(store))
    assert figures.causes == {"shot_down_3": 2, "left_field": 1}
    assert figures.mean_return == 2.0 and figures.return_ci95 is not None
    assert figures.return_ci95[1] - 2.0 == pytest.approx(1.959964 * np.std([4, 2, 2, 0], ddof=1) / 2.0)
    assert figures.command == "workbench evaluate expert-dragging --mask 2,3,4 --episodes 20 --seed 70368744177664"


def test_shipped_figures_are_those_of_fig_13_and_only_of_exactly_that_work(store: RunStore) -> None:
    result = shipped_set()
    assert result is not None
    task = task_for()
    work = _work(store, "expert-dragging", task, 1000)
    figures, number = shipped_figures(work, task), result.number("expert", "target", None)
    assert figures is not None and number is not None and figures.shipped
    assert (figures.success_rate, figures.command) == (number.success_rate, number.command)
    assert sum(figures.causes.values()) == 1000 - round(1000 * figures.success_rate)
    for other in ({"seed": 1}, {"episodes": 999}, {"policy_digest": "0" * 12}, {"scenario_digest": "0" * 12}):
        assert shipped_figures(dataclasses.replace(work, **other), task) is None
