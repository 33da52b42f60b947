"""A search for a calibrated scenario at the terminal: its budget, its progress, and the scenario file it leaves."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from agents.scenario_search import Candidate, search, shortlist
from sim.errors import SubMasError, UsageError
from sim.scenario_file import load_scenario, scenario_text
from workbench.run_files import write_bytes

if TYPE_CHECKING:
    from workbench.progress import Bar

USUAL_CANDIDATES = 200
CANDIDATES_LIMIT = 100_000
MINUTES_LIMIT = 7 * 24 * 60


@dataclass(frozen=True)
class Budget:
    """When a search ends at the latest: after so many candidates or so many minutes, whichever is first."""

    candidates: int | None
    minutes: float | None

    @classmethod
    def of(cls, candidates: int | None, minutes: float | None) -> Budget:
        """The budget a person asked for; 200 candidates when nothing was said.

        Raises:
            UsageError: a number is out of range.
        """
        if candidates is not None and not 1 <= candidates <= CANDIDATES_LIMIT:
            raise UsageError(f"--candidates is {candidates}; legal are 1 to {CANDIDATES_LIMIT}")
        if minutes is not None and not 0.0 < minutes <= MINUTES_LIMIT:
            raise UsageError(f"--minutes is {minutes:g}; legal is more than 0 and at most {MINUTES_LIMIT} (a week)")
        return cls(USUAL_CANDIDATES if candidates is None and minutes is None else candidates, minutes)

    def __str__(self) -> str:
        """As it is written on a command line."""
        said = [("--candidates", self.candidates), ("--minutes", self.minutes)]
        return " ".join(f"{flag} {number:g}" for flag, number in said if number is not None)


@dataclass(frozen=True)
class Order:
    """One search as it was asked for."""

    scenario: str
    """Name or path of the scenario that the other numbers come from."""
    seed: int
    budget: Budget
    out: Path
    """The scenario file to write."""

    @property
    def command(self) -> str:
        """The command line that repeats the search."""
        base = "" if self.scenario == "default" else f"--scenario {self.scenario} "
        return f"workbench calibrate --search {base}--seed {self.seed} {self.budget} --out {self.out.name}"


@dataclass(frozen=True)
class Finding:
    """What a search came to."""

    best: Candidate | None
    """None when it was ended before the first candidate was measured."""
    tried: int
    """Candidates proposed."""
    interrupted: bool
    """Whether it was ended by Ctrl-C."""


class _TimeUp(Exception):
    """The minutes are over."""


def check_out(out: Path, force: bool) -> None:
    """Refuse a file that cannot or must not be written, before the search begins.

    Raises:
        UsageError: no .toml file, no folder, a file that exists already, or a name that no scenario can have.
    """
    if out.suffix != ".toml":
        raise UsageError(f"--out {out} is not a .toml file; a scenario file is")
    if not out.parent.is_dir():
        raise UsageError(f"--out {out}: there is no folder {out.parent}")
    if out.is_dir():
        raise UsageError(f"--out {out} is a folder; name a file")
    if out.exists() and not force:
        raise UsageError(f"--out {out} exists already; name another file, or add --force to replace it")
    scenario_text(dataclasses.replace(load_scenario(), name=out.stem))


def find(order: Order, bar: Bar) -> Finding:
    """Search until a candidate meets every target, the budget is used up or Ctrl-C is pressed; the best is kept.

    Raises:
        ScenarioError: there is no such scenario, or it leaves no room for the dials.
    """
    best: list[Candidate] = []
    tried, interrupted = 0, False
    steps = search(load_scenario(order.scenario), order.seed, order.budget.candidates, _clock(order.budget, bar))
    try:
        for candidate in steps:
            tried, before = candidate.number, best[:1]
            best = shortlist(best, candidate)
            if best[:1] != before:
                bar.say(f"best so far: {told(best[0])}")
    except _TimeUp:
        pass
    except KeyboardInterrupt:
        interrupted = True
    return Finding(best[0] if best else None, tried, interrupted)


def _clock(budget: Budget, bar: Bar) -> Callable[[int], None]:
    """Moves the bar after every flight and ends the search when its minutes are over."""
    started = time.monotonic()

    def tick(done: int) -> None:
        if budget.minutes is None:
            bar(done, budget.candidates or USUAL_CANDIDATES)
            return
        elapsed_s, limit_s = time.monotonic() - started, 60.0 * budget.minutes
        bar(round(min(elapsed_s, limit_s)), round(limit_s))
        if elapsed_s >= limit_s:
            raise _TimeUp

    return tick


def told(candidate: Candidate) -> str:
    """A candidate and its measurements in one line."""
    measured = candidate.calibration
    met = sum(target.ok for target in measured.targets)
    figures = f"{met} of {len(measured.targets)} measured targets met with {measured.episodes} engagements each"
    return f"candidate {candidate.number}, shortfall {measured.shortfall:.3f}, {figures}"


def write(order: Order, best: Candidate) -> None:
    """Write the scenario file; it says how it was found.

    Raises:
        SubMasError: the file cannot be written.
    """
    description = f"Found by {order.command}: {told(best)}"
    named = dataclasses.replace(best.scenario, name=order.out.stem, description=description)
    write_bytes(order.out, scenario_text(named).encode())


def nothing_found(order: Order) -> SubMasError:
    """The sentence for a search that ended before anything was measured."""
    return SubMasError(f"no candidate was measured in {order.budget.minutes:g} minutes; give the search more time")
