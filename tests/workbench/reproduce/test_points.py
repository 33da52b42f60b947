"""Points of the scorecard: what decides, what is left undecided, and what is not there yet."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from agents.statistics import Interval
from tests.workbench.reproduce.samples import Success, flight, made
from workbench.reproduce.points import POINTS, above, difference, every, finding, within
from workbench.reproduce.protocol import ITEMS, Item
from workbench.reproduce.result_set import ResultSet


def verdicts(result: ResultSet) -> list[str]:
    return [(finding(point, result) or ("not run",))[0] for point in POINTS[result.item]]


def as_in_the_paper(variant: str, task: str, seed: int, purpose: str) -> float:
    """What the paper reports, with a little spread between seeds."""
    spread = 0.002 * (seed - 4.5) * (5.0 if variant == "wo-pd" else 1.0)
    if purpose == "curve":  # the first evaluation: the jump-start
        return (0.1 if variant == "wo-pr" else 0.6) + spread
    easy = {"wo-pr": 0.5}.get(variant, 0.95)
    hard = {"submas": 0.948, "wo-pd": 0.808, "dec-pd": 0.854, "dec-pr": 0.862}.get(variant, 0.0)
    # Of the fixed policies (Fig. 13) SubMas-RL gets a little worse, the expert much.
    return max((hard if task == "target" else easy) + spread, 0.0)


def experts_as_in_the_paper(variant: str, task: str, seed: int, purpose: str) -> float:
    return {("expert", "target"): 0.621, ("submas", "target"): 0.948}.get((variant, task), 0.995)


@pytest.mark.parametrize(
    ("item", "success", "expected"),
    [
        ("table4", as_in_the_paper, ["yes", "–"]),
        ("fig8", as_in_the_paper, ["yes", "yes", "yes", "yes"]),
        ("fig13", experts_as_in_the_paper, ["yes", "yes", "yes"]),
    ],
)
def test_the_papers_own_numbers_bear_out_what_it_says(item: Item, success: Success, expected: list[str]) -> None:
    assert verdicts(made(item, success=success)) == expected


def test_what_the_paper_says_of_returns_needs_its_order() -> None:
    returns = {"submas": 466.34, "td3": 64.61, "ppo": -310.70, "sac": 77.17}
    result = made("fig9", success=as_in_the_paper)

    def told(order: dict[str, float]) -> ResultSet:
        numbers = [dataclasses.replace(n, mean_return=order[n.variant] + 0.1 * (n.seed or 0)) for n in result.numbers]
        return dataclasses.replace(result, numbers=tuple(numbers))

    assert verdicts(told(returns)) == ["yes", "yes"]
    assert verdicts(told(returns | {"sac": -400.0})) == ["yes", "no"]


@pytest.mark.parametrize(
    ("item", "changed", "expected"),
    [
        # Each point has numbers with which it does not hold.
        ("table4", {"submas": 0.5}, ["no", "–"]),
        ("fig8", {"wo-pd": 0.99}, ["no", "no", "yes", "yes"]),
        ("fig8", {"wo-pr": 0.99}, ["yes", "yes", "no", "yes"]),
        ("fig8", {"dec-pd": 0.99}, ["yes", "yes", "yes", "no"]),
        ("fig9", {"td3": 0.3}, ["no", "undecided"]),
    ],
)
def test_every_point_can_fail(item: Item, changed: dict[str, float], expected: list[str]) -> None:
    def success(variant: str, task: str, seed: int, purpose: str) -> float:
        return changed.get(variant, as_in_the_paper(variant, task, seed, purpose))

    found = verdicts(made(item, success=success))
    assert [one for one, wanted in zip(found, expected, strict=True) if wanted == "no"] == ["no"] * expected.count("no")
    if item != "fig9":
        assert found == expected


def test_fig_13_fails_with_an_expert_that_is_as_good() -> None:
    assert verdicts(made("fig13", success=lambda *_: 0.95)) == ["no", "no", "undecided"]


def test_fig_12_asks_for_the_beam() -> None:
    base = made("fig12")
    assert verdicts(base) == ["yes", "yes"]
    turned = dataclasses.replace(base, flights=(flight("submas", 0.1), flight("expert", 0.9)))
    assert verdicts(turned) == ["yes", "no"]


@pytest.mark.parametrize("item", ITEMS)
def test_without_numbers_nothing_is_said(item: Item) -> None:
    empty = dataclasses.replace(made(item), numbers=(), curves=(), flights=(), trainings=())
    assert {finding(point, None) for point in POINTS[item]} == {None}
    assert {finding(point, empty) for point in POINTS[item]} == {None}


@pytest.mark.parametrize("seeds", [1, 2])
def test_one_or_two_seeds_decide_nothing(seeds: int) -> None:
    assert set(verdicts(made("table4", seeds=seeds, success=as_in_the_paper))) == {"undecided", "–"}
    assert set(verdicts(made("fig8", seeds=seeds, success=as_in_the_paper))) == {"undecided"}


def test_seeds_that_overlap_leave_it_undecided() -> None:
    generator = np.random.default_rng(0)
    one, other = generator.normal(0.90, 0.05, 5), generator.normal(0.91, 0.05, 5)
    assert above(difference(list(one), list(other))) == "undecided"
    assert above(difference(list(one + 0.5), list(other))) == "yes"
    assert above(difference(list(one - 0.5), list(other))) == "no"


def test_the_difference_is_one_of_interquartile_means() -> None:
    interval = difference([1.0, 1.0, 1.0, 100.0], [0.25, 0.25, 0.25, 0.25])
    assert interval.value == 0.75
    with pytest.raises(LookupError):
        difference([], [1.0])


def interval(low: float, high: float) -> Interval:
    return Interval(np.array((low + high) / 2.0), np.array(low), np.array(high))


@pytest.mark.parametrize(
    ("bounds", "is_above", "is_within"),
    [
        ((0.01, 0.05), "yes", "yes"),
        ((-0.05, 0.05), "undecided", "yes"),
        ((-0.05, -0.01), "no", "yes"),
        ((0.05, 0.15), "yes", "undecided"),
        ((0.15, 0.25), "yes", "no"),
        ((-0.25, -0.15), "no", "no"),
        ((-0.25, 0.25), "undecided", "undecided"),
    ],
)
def test_an_interval_decides_or_not(bounds: tuple[float, float], is_above: str, is_within: str) -> None:
    assert (above(interval(*bounds)), within(interval(*bounds), 0.1)) == (is_above, is_within)


def test_all_must_hold() -> None:
    assert every(["yes", "yes"]) == "yes"
    assert every(["yes", "undecided"]) == "undecided"
    assert every(["undecided", "no", "yes"]) == "no"
