"""A search for scenarios that meet the calibration targets: cheap screening first, then refinement around the best."""

from __future__ import annotations

import math
from bisect import insort
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Final

import numpy as np

from agents.calibration import ALL_LINES, TELLING_LINES, WINNABLE_STATES, Lines, measure
from agents.calibration_bench import Bench
from agents.calibration_table import Calibration
from agents.scenario_dials import Settings, check_base, drawn, refined, with_settings
from sim.scenario import Scenario

PROMOTED_SHARE: Final = 1 / 3
"""Of the candidates that pass a rung, the share that is measured on the next one (asynchronous successive halving)."""
UNKNOWN: Final = 0.2
"""Shortfall that a group of lines is taken to have when it was spared: so much may hide behind a line surely missed."""
DOUBTED: Final = 0.1
"""Weight of the doubt beside the shortfall: few episodes flatter, and a scenario should not just graze its bounds."""
ELITE: Final = 8
"""Candidates that proposals are refined around."""
DRAWN_FIRST: Final = 30
"""Candidates drawn anywhere before the first refinement: nearly all are dropped after one short flight."""
DRAWN_SHARE: Final = 0.3
"""Share of proposals that are still drawn anywhere after that."""
SEARCH_SEEDS: Final = 1_000_000
"""Seeds of initial states begin here in a search, so that `workbench calibrate`, with its own, is a fresh test."""

Tick = Callable[[int], None]
"""Called after every flight with the number of candidates that are done; what it raises ends the search."""


@dataclass(frozen=True)
class Rung:
    """How thoroughly a candidate is measured."""

    episodes: int
    """Engagements per policy and task."""
    lines: Sequence[Lines]
    """Groups of lines, the cheapest and most telling first."""
    give_up: bool = False
    """Whether the groups behind a line that is surely missed are spared."""


RUNGS: Final = (Rung(48, TELLING_LINES, give_up=True), Rung(150, ALL_LINES), Rung(1000, ALL_LINES))


@dataclass(frozen=True)
class Candidate:
    """A proposed scenario as measured on one rung."""

    number: int
    """1, 2, … in the order of the proposals."""
    settings: Settings
    scenario: Scenario
    rung: int
    """Index of the rung."""
    calibration: Calibration
    """The lines of this rung."""
    met: bool
    """Whether it meets every target on the last rung."""

    @property
    def rank(self) -> tuple[bool, float, int]:
        """Smaller is better: one that meets every target, then those closest to the targets and least in doubt."""
        measured = self.calibration
        distance = measured.shortfall + UNKNOWN * measured.spared + DOUBTED * measured.doubt
        return not self.met, distance, self.number


def search(
    base: Scenario, seed: int, candidates: int | None = None, tick: Tick | None = None, rungs: Sequence[Rung] = RUNGS
) -> Iterator[Candidate]:
    """Propose scenarios, measure them, and yield each anew for every rung it reaches.

    Proposals depend on the seed and on what was measured before, on nothing else: a smaller number of candidates is
    a beginning of the same search. It ends early with a candidate that meets every target on the last rung.

    Args:
        base: what the dials do not choose, the number of missiles among it.
        seed: seed of the proposals and of the initial states.
        candidates: how many are proposed; endless by default.
        tick: told how far it is after every flight.
        rungs: from cheap to thorough.

    Raises:
        ScenarioError: the base leaves no room for some settings of the dials.
    """
    check_base(base)
    race = _Race(base, seed, tick, rungs)
    for number in count(1) if candidates is None else range(1, candidates + 1):
        for candidate in race.run(number):
            yield candidate
            if candidate.met:
                return


def shortlist(best: Sequence[Candidate], new: Candidate) -> list[Candidate]:
    """The best candidates, best first, each by its latest measurement: luck on an early rung is forgotten."""
    others = [candidate for candidate in best if candidate.number != new.number]
    return sorted([*others, new], key=lambda candidate: candidate.rank)[:ELITE]


class _Race:
    """What a search remembers: its draws, the elite, and the shortfalls of those that passed each rung."""

    def __init__(self, base: Scenario, seed: int, tick: Tick | None, rungs: Sequence[Rung]) -> None:
        self._base, self._seed, self._tick, self._rungs = base, seed, tick, rungs
        self._draws = np.random.default_rng(seed)
        self._elite: list[Candidate] = []
        self._passed: list[list[float]] = [[] for _ in rungs]

    def run(self, number: int) -> Iterator[Candidate]:
        """Propose one candidate and measure it on rung after rung, as long as it is promoted."""
        settings = self._propose(number)
        scenario = with_settings(self._base, settings, f"candidate-{number}", "")
        for rung in range(len(self._rungs)):
            candidate = self._measure(number, settings, scenario, rung)
            self._elite = shortlist(self._elite, candidate)
            yield candidate
            if not self._promoted(candidate):
                break

    def _propose(self, number: int) -> Settings:
        if number <= DRAWN_FIRST or self._draws.random() < DRAWN_SHARE:
            return drawn(self._draws)
        # The better, the likelier: each place half as likely as the one before it.
        place = min(int(self._draws.geometric(0.5)) - 1, len(self._elite) - 1)
        return refined(self._draws, self._elite[place].settings)

    def _measure(self, number: int, settings: Settings, scenario: Scenario, rung: int) -> Candidate:
        plan, tick = self._rungs[rung], self._tick
        told = None if tick is None else lambda _flights: tick(number - 1)
        # Every rung has initial states of its own: luck on one does not help on the next.
        seed = SEARCH_SEEDS + self._seed * len(self._rungs) + rung
        bench = Bench(scenario, plan.episodes, seed, min(plan.episodes, WINNABLE_STATES), told)
        calibration = measure(bench, plan.lines, give_up=plan.give_up)
        met = rung == len(self._rungs) - 1 and calibration.ok
        return Candidate(number, settings, scenario, rung, calibration, met)

    def _promoted(self, candidate: Candidate) -> bool:
        if candidate.calibration.missed:
            return False
        passed, shortfall = self._passed[candidate.rung], candidate.calibration.shortfall
        insort(passed, shortfall)
        return shortfall <= passed[math.ceil(len(passed) * PROMOTED_SHARE) - 1]
