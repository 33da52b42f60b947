"""Comparisons without a page: names of work, the cache, what workers do, the grid, tables."""

from __future__ import annotations

import csv
import dataclasses
import io
import json

import numpy as np
import pytest

from agents.episodes import EpisodeResults
from agents.evaluation import evaluate
from agents.policy import bind
from sim.task import task_for
from sim.trajectory import fly
from tests.workbench.comparison.works import ONE_MISSILE, SEED, some_work
from workbench.comparison import work as work_module
from workbench.comparison.cache import ComparisonCache, evaluation_to_json
from workbench.comparison.closely import look_closely
from workbench.comparison.flights import do, survival_axes
from workbench.comparison.grid import build_grid, tasks_of
from workbench.comparison.policies import CHAIN, chain_policy, entry
from workbench.comparison.tables import engagements_table, figures_table, pairs_table
from workbench.comparison.work import ComparisonError, Work
from workbench.policies import resolve_policy
from workbench.runs import RunStore

PATIENCE_S = 300.0


# Work and its name


def test_the_name_changes_with_everything_that_changes_a_flight(store: RunStore) -> None:
    work = some_work(store)
    changes = {
        "policy": "expert-navigation", "scenario_digest": "0" * 12, "mask": "", "seed": 1, "episodes": 21,
        "policy_digest": "0" * 12, "kind": "tracks", "numbers": (1,),
    }  # fmt: skip
    names = {dataclasses.replace(work, **{field: value}).name for field, value in changes.items()}
    assert len(names) == len(changes) and work.name not in names


def test_a_policy_is_the_same_under_whatever_name_it_was_found(store: RunStore) -> None:
    work = some_work(store, "submas-target", task_for())
    assert work.policy_digest
    assert dataclasses.replace(work, policy="20261122-000000-abcdef").name == work.name


def test_another_version_of_the_simulator_flies_again(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    before = some_work(store).name
    monkeypatch.setattr(work_module, "source", lambda: "another")
    assert some_work(store).name != before


def test_work_survives_json(store: RunStore) -> None:
    work = dataclasses.replace(some_work(store), numbers=(3, 1))
    assert Work.from_json(json.loads(json.dumps(work.to_json()))) == work


# The cache


def test_an_evaluation_comes_back_as_it_was(store: RunStore, cache: ComparisonCache) -> None:
    work = some_work(store)
    flown = evaluate(resolve_policy(work.policy), ONE_MISSILE, 20, SEED)
    cache.write(work, evaluation_to_json(flown))
    back = cache.evaluation(work)
    assert back == flown  # the figures
    assert back is not None and back.results is not None and flown.results is not None
    for field in dataclasses.fields(EpisodeResults):
        np.testing.assert_allclose(getattr(back.results, field.name), getattr(flown.results, field.name), atol=0.01)


@pytest.mark.parametrize("content", ["", "[]", "{", '{"figures": 1}', "null", "[" * 10_000])
def test_a_damaged_result_is_no_result_and_goes(store: RunStore, cache: ComparisonCache, content: str) -> None:
    work = some_work(store)
    cache.write(work, {})
    path = next(cache.folder.iterdir())
    path.write_text(content)
    assert cache.evaluation(work) is None and not path.exists()


def test_columns_of_another_length_are_refused(store: RunStore, cache: ComparisonCache) -> None:
    work = some_work(store)
    values = evaluation_to_json(evaluate(resolve_policy(work.policy), ONE_MISSILE, 2, SEED))
    values["episodes"]["killer"].append(0)
    cache.write(work, values)
    assert cache.evaluation(work) is None


# What workers do


def test_a_worker_counts_what_the_one_evaluator_counts(store: RunStore) -> None:
    shares: list[float] = []
    work = some_work(store)
    values = do(work, store.root, shares.append)
    expected = evaluation_to_json(evaluate(resolve_policy(work.policy), ONE_MISSILE, 20, SEED))
    assert values["episodes"] == expected["episodes"]
    assert shares == sorted(shares) and 0.0 < shares[-1] <= 1.0


def test_tracks_are_those_of_the_recorded_flight(store: RunStore) -> None:
    work = entry("submas-source-3", ONE_MISSILE, store).work("tracks", "default", ONE_MISSILE, SEED, numbers=(4, 11))
    tracks = do(work, store.root, lambda share: None)["tracks"]
    assert [track["episode"] for track in tracks] == [4, 11]
    for track in tracks:
        flight = fly(ONE_MISSILE, bind(resolve_policy("submas-source-3"), ONE_MISSILE), "", SEED, track["episode"])
        assert track["outcome"] == flight.outcome.name.lower()
        assert track["closest_m"] == pytest.approx(flight.missiles[0].closest_m, abs=0.02)
        np.testing.assert_allclose(track["evader"][0], flight.evader.position_m[0, :2] / 1e3, atol=0.01)
        flown = flight.missiles[0].position_m
        first, last = flown[np.isfinite(flown[:, 0])][[0, -1], :2] / 1e3
        np.testing.assert_allclose(track["missiles"]["1"]["path"][0], first, atol=2.0)
        np.testing.assert_allclose(track["missiles"]["1"]["path"][-1], last, atol=2.0)


def test_a_policy_that_has_changed_is_not_flown_under_the_old_name(store: RunStore) -> None:
    work = dataclasses.replace(some_work(store, "submas-target", task_for()), policy_digest="0" * 12)
    with pytest.raises(ComparisonError, match="fly again"):
        do(work, store.root, lambda share: None)


# The grid


def test_every_task_has_a_name_and_the_chain_comes_first() -> None:
    tasks = tasks_of(task_for().scenario)
    assert list(tasks)[:5] == ["source-4", "source-3", "source-2", "source-1", "target"]
    assert len(tasks) == 16 and all(task.name == name for name, task in tasks.items())


def test_the_chain_flies_each_task_with_its_own_policy() -> None:
    tasks = tasks_of(task_for().scenario)
    flown = [chain_policy(task) for task in tasks.values()]
    assert flown[:5] == ["expert-navigation", "submas-source-3", "submas-source-2", "submas-source-1", "submas-target"]
    assert set(flown[5:]) == {""}


def test_a_grid_says_who_cannot_fly_and_who_flies_elsewhere(store: RunStore, cache: ComparisonCache) -> None:
    policies = (CHAIN, "submas-source-3", "submas-target", "expert-dragging")
    grid = build_grid(policies, ["source-3", "target", "missiles-2-4"], "default", 1000, SEED, store, cache)
    assert "cannot see missiles 2, 3, 4" in grid.cell("submas-source-3", "target").entry.blind
    assert "no policy trained for missiles-2-4" in grid.cell(CHAIN, "missiles-2-4").entry.blind
    assert "trained for target" in grid.cell("submas-target", "source-3").entry.note
    assert not grid.cell(CHAIN, "source-3").entry.note and not grid.cell("expert-dragging", "target").entry.note
    notes = grid.notes()
    assert len(notes) == len(set(notes)) >= 3
    other = build_grid(("submas-target",), ["target"], "short-range", 100, SEED, store, cache)
    assert "trained on scenario 'default'" in other.notes()[0]
    assert grid.cell("expert-dragging", "target").figures is not None  # Fig. 13
    assert len(grid.unflown()) == 12 - 3


def test_a_closer_look_wants_what_is_missing_and_shows_what_is_there(store: RunStore, cache: ComparisonCache) -> None:
    def grid_of() -> tuple:
        grid = build_grid(("expert-dragging", "expert-navigation"), ["source-3"], "default", 60, SEED, store, cache)
        pair = ("expert-dragging", "expert-navigation")
        return grid, look_closely(grid, "source-3", pair, ("A", "B"), cache)

    grid, close = grid_of()
    assert [work.kind for work in close.wanted] == ["evaluation", "evaluation", "survival", "survival"]
    for work in close.wanted[:3]:
        cache.write(work, do(work, store.root, lambda share: None))
    grid, close = grid_of()
    assert close.pairs["source-3"].episodes == 60 and close.strips and close.tracks is None
    assert [work.kind for work in close.wanted] == ["survival", "tracks"]
    shots = close.maps["expert-dragging"]
    assert shots is not None and shots.survived.shape == tuple(
        len(axis.values) for axis in survival_axes(ONE_MISSILE.scenario)
    )
    assert 0.0 < shots.survived.mean() < 1.0
    cache.write(close.wanted[1], do(close.wanted[1], store.root, lambda share: None))
    tracks = grid_of()[1].tracks
    assert tracks is not None and set(tracks) == {episode for strip in close.strips for episode in strip.episodes}

    rows = list(csv.DictReader(io.StringIO(figures_table(grid))))
    assert [row["policy"] for row in rows] == ["expert-dragging", "expert-navigation"]
    assert float(rows[0]["success_rate"]) == grid.cell("expert-dragging", "source-3").figures.success_rate
    pairs = list(csv.DictReader(io.StringIO(pairs_table("a", "b", close.pairs))))
    assert int(pairs[0]["both"]) + int(pairs[0]["only_a"]) + int(pairs[0]["only_b"]) + int(pairs[0]["neither"]) == 60
    evaluation = grid.cell("expert-dragging", "source-3").evaluation
    engagements = list(csv.DictReader(io.StringIO(engagements_table([evaluation]))))
    assert len(engagements) == 60 and engagements[5]["episode"] == "5" and engagements[5]["seed"] == str(SEED)
