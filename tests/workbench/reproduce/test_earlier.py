"""Result sets that are added to: what they hold is kept row by row, and only the rest is wanted."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from sim.errors import UsageError
from tests.workbench.reproduce.samples import made
from workbench.reproduce.earlier import earlier
from workbench.reproduce.plan import Plan, make_plan
from workbench.reproduce.protocol import EPISODES, Item
from workbench.reproduce.provenance import Provenance
from workbench.reproduce.result_file import ResultSetError, save
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.seed_counts import SeedCounts
from workbench.reproduce.stage_curves import POINTS_OF_A_FILE


def plan(item: Item, seeds: int = 3) -> Plan:
    return make_plan(item, "fast", SeedCounts.each(seeds), EPISODES)


def origin(of: ResultSet) -> Provenance:
    return Provenance(of.scenario_digest, of.source_digest, of.code_version)


def only(result: ResultSet, *seeds: int) -> ResultSet:
    """The same result set, trained with these seeds alone."""
    return dataclasses.replace(
        result,
        trainings=tuple(row for row in result.trainings if row.seed in seeds),
        numbers=tuple(row for row in result.numbers if row.seed in seeds),
        curves=tuple(row for row in result.curves if row.seed in seeds),
    )


@pytest.mark.parametrize("item", ["table4", "fig8", "fig9"])
def test_two_halves_of_a_result_set_are_the_whole(tmp_path: Path, item: Item) -> None:
    whole = made(item, seeds=3)
    save(only(whole, 0, 2), tmp_path / f"{item}.json")
    before = earlier([plan(item)], tmp_path, origin(whole))
    assert before.added_to(plan(item), only(whole, 1)) == whole


def test_what_one_of_two_result_sets_lacks_is_wanted_again(tmp_path: Path) -> None:
    plans = [plan("table4"), plan("fig8")]
    save(only(made("table4", seeds=3), 0, 1), tmp_path / "table4.json")
    save(only(made("fig8", seeds=3), 0), tmp_path / "fig8.json")
    kept = [dict(key) for key in earlier(plans, tmp_path, origin(made("fig8"))).keys]
    seeds = {name: {one["seed"] for one in kept if one["variant"] == name} for name in ("submas", "wo-pr", "sac")}
    assert seeds == {"submas": {0}, "wo-pr": {0}, "sac": {0, 1}}, "SAC is in Table 4 alone"


@pytest.mark.parametrize("lost", ["numbers", "curves", "trainings"])
def test_a_training_with_a_row_lost_is_wanted_again(tmp_path: Path, lost: str) -> None:
    whole = made("fig9", seeds=2)
    save(dataclasses.replace(whole, **{lost: getattr(whole, lost)[1:]}), tmp_path / "fig9.json")
    assert len(earlier([plan("fig9", 2)], tmp_path, origin(whole)).keys) == len(whole.trainings) - 1


def test_one_that_failed_is_wanted_again(tmp_path: Path) -> None:
    whole = made("fig9", seeds=1)
    first = dataclasses.replace(whole.trainings[0], state="failed")
    save(dataclasses.replace(whole, trainings=(first, *whole.trainings[1:])), tmp_path / "fig9.json")
    assert len(earlier([plan("fig9", 1)], tmp_path, origin(whole)).keys) == len(whole.trainings) - 1


def test_curves_of_both_together_fit_a_file(tmp_path: Path) -> None:
    whole = made("fig8", seeds=10, points=50)
    save(only(whole, 0, 1, 2, 3), tmp_path / "fig8.json")
    before = earlier([plan("fig8", 10)], tmp_path, origin(whole))
    merged = before.added_to(plan("fig8", 10), only(whole, 4, 5, 6, 7, 8, 9))
    assert POINTS_OF_A_FILE * 0.9 < sum(len(curve.env_steps) for curve in merged.curves) <= POINTS_OF_A_FILE
    assert {(c.env_steps[0], c.env_steps[-1]) for c in merged.curves} == {(20_480, 50 * 20_480)}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"source_digest": "another"}, "its source is another, this one's"),
        ({"scenario_digest": "another"}, "its scenario is another"),
        ({"profile": "paper"}, "its profile is paper, this one's fast"),
        ({"episodes": 7}, "its number of episodes is 7, this one's 1000"),
    ],
)
def test_what_is_not_comparable_is_not_mixed(tmp_path: Path, change: dict[str, object], says: str) -> None:
    whole = made("fig9", seeds=2)
    save(dataclasses.replace(whole, **change), tmp_path / "fig9.json")  # pyright: ignore[reportArgumentType]
    with pytest.raises(UsageError, match=says):
        earlier([plan("fig9")], tmp_path, origin(whole))


def test_a_damaged_result_set_is_not_lost_by_adding_to_it(tmp_path: Path) -> None:
    (tmp_path / "fig9.json").write_text("{")
    with pytest.raises(ResultSetError, match="damaged"):
        earlier([plan("fig9")], tmp_path, origin(made("fig9")))


def test_without_any_there_is_nothing_to_keep(tmp_path: Path) -> None:
    whole = made("fig9", seeds=1)
    before = earlier([plan("fig9", 1)], tmp_path, origin(whole))
    assert not before.keys and before.added_to(plan("fig9", 1), whole) is whole
