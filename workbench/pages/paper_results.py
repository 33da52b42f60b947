"""Result sets as the Paper page finds them: those that come with the workbench, and those of its own runs folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from agents.config import PROFILES
from workbench.reproduce.places import committed_results
from workbench.reproduce.protocol import ITEMS, Item
from workbench.reproduce.result_file import ResultSetError, load
from workbench.reproduce.result_set import ResultSet
from workbench.run_files import Signature, signature
from workbench.runs import RunStore

HERE = "-here"
"""Ends the name of a source that is in the runs folder."""


@dataclass(frozen=True)
class Source:
    """A folder of result sets of one profile."""

    key: str
    """Its name in the address."""
    label: str
    profile: str
    folder: Path


@dataclass(frozen=True)
class Results:
    """Everything in one folder, read at once."""

    source: Source
    sets: dict[Item, ResultSet | None] = field(default_factory=dict)
    problems: tuple[str, ...] = ()
    """What is wrong with files that cannot be read."""


def results_root(store: RunStore) -> Path:
    """Where reproductions that a page starts put their results: never over those that come with the workbench."""
    return store.root / "results"


def own_source(store: RunStore, profile: str) -> Source:
    """The results of a profile in this runs folder, whether there are any or not."""
    return Source(profile + HERE, f"{profile}, run here", profile, results_root(store) / profile)


def sources(store: RunStore) -> list[Source]:
    """Folders that hold result sets, what comes with the workbench first; never empty."""
    shipped = committed_results()
    found = []
    for profile in sorted(PROFILES, key=lambda name: name != "fast"):
        if shipped is not None and _any(shipped / profile):
            found.append(Source(profile, f"{profile}, comes with the workbench", profile, shipped / profile))
    found += [own for profile in PROFILES if _any((own := own_source(store, profile)).folder)]
    return found or [own_source(store, "fast")]


def chosen_source(key: str, store: RunStore) -> tuple[Source, str]:
    """The source an address names, and a sentence if there is none of that name."""
    there = {source.key: source for source in sources(store)}
    own = {one.key: one for one in (own_source(store, profile) for profile in PROFILES)}
    if key in there | own:
        return (there | own)[key], ""
    first = next(iter(there.values()))
    return first, f"Results {key[:40]!r} are not known here; these are {first.label}." if key else ""


def signatures(source: Source) -> Sequence[Signature]:
    """Differs once a result set of this folder has changed."""
    return [signature(source.folder / f"{item}.json") for item in ITEMS]


def read_results(source: Source) -> Results:
    """All result sets of a folder; one that cannot be read counts as not run, and its problem is told."""
    sets: dict[Item, ResultSet | None] = {}
    problems = []
    for item in ITEMS:
        try:
            sets[item] = load(source.folder / f"{item}.json")
        except ResultSetError as error:
            sets[item] = None
            problems.append(str(error))
    return Results(source, sets, tuple(problems))


def _any(folder: Path) -> bool:
    return any((folder / f"{item}.json").is_file() for item in ITEMS)
