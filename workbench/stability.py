"""The study of stability: trials in processes of their own, kept as lines of a file, summed up as a table."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from agents.remedies import REMEDIES
from agents.trial import Trial, run_trial
from sim.errors import SubMasError
from workbench.engine import Engine
from workbench.run_files import write_bytes

SIZE_LIMIT: Final = 2_000_000
"""Largest file that is read [bytes]."""
GUIDE: Final = "submas-source-1"
"""POLICY that guides: the shipped one of the next easier task."""
BLOCK: Final = "<!-- stability -->\n"
END: Final = "\n<!-- end -->"
SeedCurve = tuple[Sequence[int], Sequence[float]]
"""Epochs and success rates of one trial."""
COLUMNS: Final = ("without", "learned, of seeds", "at epoch", "worst fall", "last five evaluations", "best, fresh")


class StabilityFileError(SubMasError):
    """The file of trials cannot be read; the message names it and what is wrong."""


@dataclass(frozen=True)
class Wish:
    """A trial that is wanted."""

    remedy: str
    seed: int


def wishes(remedies: Sequence[str], seeds: Iterable[int], known: Iterable[Trial]) -> list[Wish]:
    """What is still to be trained, seed by seed, so that after a while there is something of every remedy."""
    there = {Wish(trial.remedy, trial.seed) for trial in known}
    wanted = [Wish(remedy, seed) for seed in seeds for remedy in remedies]
    return [wish for wish in wanted if wish not in there]


def trials(wanted: Sequence[Wish], engine: Engine) -> Iterator[Trial]:
    """Train them, some at once, each in a process of its own; in the order in which they end."""
    yield from (trial for _, trial in engine.each(shipped_trial, [(wish.remedy, wish.seed) for wish in wanted]))


def shipped_trial(remedy: str, seed: int) -> Trial:
    """One trial with the shipped guide."""
    from workbench.policies import resolve_policy

    return run_trial(remedy, seed, resolve_policy(GUIDE), lambda _done, _of: None)


def load(path: Path) -> list[Trial]:
    """The trials in a file, none if it is not there.

    Raises:
        StabilityFileError: the file is damaged.
    """
    if not path.is_file():
        return []
    if path.stat().st_size > SIZE_LIMIT:
        raise StabilityFileError(f"{path} has {path.stat().st_size} bytes; a file of trials has at most {SIZE_LIMIT}")
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        try:
            found.append(_trial(json.loads(line)))
        except (ValueError, TypeError, KeyError) as error:
            raise StabilityFileError(f"{path}, line {number}, is no trial: {error}") from error
    return found


def _trial(plain: Any) -> Trial:
    if not isinstance(plain, dict):
        raise ValueError("it is not an object")
    values: dict[str, Any] = {n: tuple(value) if isinstance(value, list) else value for n, value in plain.items()}
    return Trial(**values)


def save(path: Path, found: Iterable[Trial]) -> None:
    """Write all trials, in the order of remedies and seeds, the whole file or nothing."""
    order = list(REMEDIES)
    ranked = sorted(found, key=lambda trial: (order.index(trial.remedy), trial.seed))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, "".join(json.dumps(trial.to_json()) + "\n" for trial in ranked).encode())


def panels(found: Sequence[Trial]) -> Iterator[tuple[str, list[SeedCurve], Sequence[float]]]:
    """What the picture shows of each remedy: its words, a curve (epochs, success) per seed, and ε of the first."""
    for name, remedy in REMEDIES.items():
        mine = [trial for trial in found if trial.remedy == name]
        if mine:
            yield remedy.says, [(trial.epochs, trial.success_rate) for trial in mine], mine[0].epsilon


def rows(found: Sequence[Trial]) -> list[tuple[str, ...]]:
    """The table: a row for each remedy that was taken away, of `COLUMNS`; medians over seeds, extremes in brackets."""
    return [_row(name, of) for name in REMEDIES if (of := [trial for trial in found if trial.remedy == name])]


def _row(remedy: str, found: Sequence[Trial]) -> tuple[str, ...]:
    arrived = [trial.arrived for trial in found if trial.arrived is not None]
    epochs = f"{np.median(arrived):g} [{min(arrived)}, {max(arrived)}]" if arrived else "–"
    return (
        REMEDIES[remedy].says,
        f"{len(arrived)} of {len(found)}",
        epochs,
        _shares([trial.worst_fall for trial in found]),
        _shares([trial.late_success for trial in found]),
        _shares([trial.final_success_rate for trial in found]),
    )


def _shares(values: Sequence[float]) -> str:
    low, middle, high = (100.0 * value for value in (min(values), float(np.median(values)), max(values)))
    return f"{middle:.1f} [{low:.1f}, {high:.1f}]"


def markdown(found: Sequence[Trial]) -> str:
    """The written part of `docs/stability.md`: picture, table, and what each remedy is meant to remove."""
    if not found:
        return "Not run yet."
    table = ["| " + " | ".join(line) + " |" for line in (COLUMNS, ("---",) * len(COLUMNS), *rows(found))]
    causes = [f"* *{remedy.says}*: {remedy.why}." for name, remedy in REMEDIES.items() if name != "none"]
    picture = "![Held-out success of every seed, without each remedy](../assets/results/stability.png)"
    return "\n\n".join([picture, "\n".join(table), "What each was meant to remove:", "\n".join(causes)])


def refresh(document: Path, found: Sequence[Trial]) -> None:
    """Write the block of the document anew; nothing happens where there is no document."""
    if document.is_file():
        before, rest = document.read_text(encoding="utf-8").split(BLOCK)
        write_bytes(document, f"{before}{BLOCK}{markdown(found)}{END}{rest.split(END)[1]}".encode())
