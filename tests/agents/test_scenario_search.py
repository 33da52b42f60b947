"""The search: repeatable, thorough only where it pays, better than chance, and finished when all targets are met."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from agents import scenario_search
from agents.calibration import dragging_on_target, navigation
from agents.calibration_bench import Bench
from agents.calibration_table import Calibration, Target
from agents.scenario_dials import DIALS, drawn
from agents.scenario_search import DRAWN_FIRST, RUNGS, Candidate, Rung, search, shortlist
from sim.errors import ScenarioError
from sim.scenario import Scenario
from sim.scenario_file import load_scenario, parse_scenario, scenario_text
from tests.engagements import changed

SHORT = changed(load_scenario(), rules={"max_steps": 80, "substeps": 4})
"""Over before anybody arrives."""
TINY = (Rung(3, (dragging_on_target,)), Rung(4, (dragging_on_target, navigation)))


def far_from_the_middle(scenario: Scenario) -> float:
    """Mean distance of three dials from the middle of their ranges, as a share of half the range."""
    dials = [dial for dial in DIALS if dial.name in ("launch.range_m", "missile.cd0", "launch.interval_s")]
    values = [getattr(getattr(scenario, dial.name.split(".")[0]), dial.name.split(".")[1]) for dial in dials]
    return sum(abs(2 * (v - d.low) / (d.high - d.low) - 1) for d, v in zip(dials, values, strict=True)) / len(dials)


def fake_flights(monkeypatch: pytest.MonkeyPatch, accepted: float, half_width: float) -> None:
    """Instead of flights, a target that is met near the middle of three dials."""

    def measured(bench: Bench, _groups: object, give_up: bool) -> Calibration:
        assert give_up is (bench.episodes == RUNGS[0].episodes)
        value = far_from_the_middle(bench.scenario)
        target = Target("distance", value, 0.0, accepted, (max(value - half_width, 0.0), value + half_width))
        return Calibration(bench.scenario.name, bench.episodes, bench.seed, (target,), ())

    monkeypatch.setattr(scenario_search, "measure", measured)


@pytest.fixture
def bowl(monkeypatch: pytest.MonkeyPatch) -> None:
    """A target that can be met."""
    fake_flights(monkeypatch, 0.12, 0.3)


def facts(candidate: Candidate) -> tuple[object, ...]:
    """Everything a candidate is, in values that compare by equality."""
    return candidate.number, dict(candidate.settings), candidate.scenario, candidate.rung, repr(candidate.calibration)


def test_the_same_seed_proposes_and_measures_the_same() -> None:
    first, again = (list(map(facts, search(SHORT, 5, 4, rungs=TINY))) for _ in range(2))
    assert first == again
    assert [facts[1] for facts in first] != [dict(one.settings) for one in search(SHORT, 6, 4, rungs=TINY)]


def test_a_found_scenario_is_one_of_its_base_and_survives_its_file() -> None:
    base = changed(SHORT, launch={"missiles": 2})
    for candidate in search(base, 1, 2, rungs=TINY):
        assert candidate.scenario.launch.missiles == 2
        assert parse_scenario(tomllib.loads(scenario_text(candidate.scenario)), "file") == candidate.scenario


@pytest.mark.usefixtures("bowl")
@pytest.mark.parametrize("seed", range(5))
def test_a_smaller_number_of_candidates_is_a_beginning_of_the_same_search(seed: int) -> None:
    long = list(map(facts, search(SHORT, seed, 30)))
    short = list(map(facts, search(SHORT, seed, 20)))
    assert short == long[: len(short)]


@pytest.mark.usefixtures("bowl")
@pytest.mark.parametrize("seed", range(5))
def test_it_ends_early_with_a_candidate_that_meets_every_target_on_the_last_rung(seed: int) -> None:
    candidates = list(search(SHORT, seed, 2000))
    assert candidates[-1].number < 2000
    assert candidates[-1].met
    assert candidates[-1].calibration.shortfall == 0.0
    assert not any(candidate.met for candidate in candidates[:-1])


@pytest.mark.usefixtures("bowl")
def test_refinement_is_better_than_chance(monkeypatch: pytest.MonkeyPatch) -> None:
    def needed(drawn_first: int) -> float:
        monkeypatch.setattr(scenario_search, "DRAWN_FIRST", drawn_first)
        return sum([list(search(SHORT, seed, 300))[-1].number for seed in range(10)]) / 10

    assert needed(DRAWN_FIRST) < 0.5 * needed(10**9)


def test_only_the_better_third_of_those_that_pass_is_measured_more_thoroughly(monkeypatch: pytest.MonkeyPatch) -> None:
    # A target that nobody meets, and one interval in which about half of the candidates may still meet it.
    monkeypatch.setattr(scenario_search, "DRAWN_FIRST", 10**9)
    fake_flights(monkeypatch, 0.0, 0.5)
    candidates = list(search(SHORT, 3, 300))
    on_rung = [[one for one in candidates if one.rung == rung] for rung in range(3)]
    passed = [sum(not one.calibration.missed for one in rung) for rung in on_rung]
    assert len(on_rung[0]) == 300
    assert 100 < passed[0] < 200
    assert len(on_rung[1]) == pytest.approx(passed[0] / 3, rel=0.25)
    # The same target again: whoever was promoted passes again, and a third of those is promoted further.
    assert passed[1] == len(on_rung[1])
    assert 0 < len(on_rung[2]) < 0.7 * len(on_rung[1])


@pytest.mark.usefixtures("bowl")
def test_every_rung_has_initial_states_of_its_own_and_no_other_search_has_them() -> None:
    seeds = {(one.rung, one.calibration.seed) for seed in range(6) for one in search(SHORT, seed, 60)}
    assert len({seed for _, seed in seeds}) == len(seeds) == 6 * len(RUNGS)


def measured(number: int, value: float, spared: int = 0, half_width: float = 0.1, met: bool = False) -> Candidate:
    """A candidate with one line, accepted up to 0.3."""
    line = Target("x", value, 0.0, 0.3, (value - half_width, value + half_width))
    settings = drawn(np.random.default_rng(number))
    return Candidate(number, settings, SHORT, 0, Calibration("x", 48, 7, (line,), (), spared), met)


def test_candidates_rank_by_shortfall_with_something_added_for_doubt_and_for_what_was_not_measured() -> None:
    # Shortfall, a tenth of how far both ends of the interval reach out, 0.2 for a spared group.
    ranked = [
        measured(6, 0.3, met=True),
        measured(2, 0.2),
        measured(1, 0.2, half_width=0.3),
        measured(4, 0.35),
        measured(3, 0.8),
        measured(5, 0.45, spared=2),
    ]
    assert sorted(ranked[::-1], key=lambda one: one.rank) == ranked
    distances = [one.rank[1] for one in ranked[1:]]
    assert distances == pytest.approx([0.0, 0.03, 0.05 + 0.015, 0.5 + 0.06, 0.15 + 0.025 + 0.4])


def test_a_shortlist_holds_every_candidate_once_by_its_latest_measurement() -> None:
    best: list[Candidate] = []
    for number in range(1, 15):
        best = shortlist(best, measured(number, 0.3 + 0.001 * number))
    assert [one.number for one in best] == [1, 2, 3, 4, 5, 6, 7, 8]
    best = shortlist(best, measured(1, 0.9))
    assert [one.number for one in best] == [2, 3, 4, 5, 6, 7, 8, 1]


def test_every_flight_is_reported_and_may_end_the_search() -> None:
    ticks: list[int] = []

    def tick(done: int) -> None:
        ticks.append(done)
        if len(ticks) == 4:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        list(search(SHORT, 5, None, tick, TINY))
    assert ticks == sorted(ticks)
    assert ticks[0] == 0
    assert ticks[-1] > 0


def test_a_base_without_room_is_refused_before_anything_is_flown() -> None:
    with pytest.raises(ScenarioError, match="the exit gate reaches beyond the right edge"):
        next(search(changed(SHORT, battlefield={"exit_half_width_m": 37.6e3}), 0))
