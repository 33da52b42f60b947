"""A mutant: the program with one fault a careless colleague would commit, and the test that must notice it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


class MutantError(Exception):
    """A mutant does not fit the source any more; the message says which and why."""


@dataclass(frozen=True)
class Mutant:
    """One fault, as one replacement in one file."""

    bar: str
    """The bar of docs/reliability.md (R…), docs/security.md (S…) or docs/cluster.md (C…) that it breaks."""
    fault: str
    """What is broken, in one sentence."""
    file: str
    """The file, relative to the repository."""
    old: str
    """What stands there exactly once."""
    new: str
    """What stands there instead."""
    tests: tuple[str, ...]
    """Each of these must fail; pytest's names, with a parameter where one of many is enough."""
    hangs: bool = False
    """Whether a test that does not come to its end counts as having noticed."""

    def broken(self, source: str) -> str:
        """The source of its file with the fault in it.

        Raises:
            MutantError: what is to be replaced does not stand there exactly once.
        """
        if (count := source.count(self.old)) != 1:
            raise MutantError(f"{self.bar}, {self.fault}: {self.old!r} stands {count} times in {self.file}")
        return source.replace(self.old, self.new)

    def apply(self, tree: Path) -> None:
        """Break the file in a copy of the repository; its links to other copies are cut.

        Raises:
            MutantError: see `broken`.
        """
        path = tree / self.file
        source = self.broken(path.read_text("utf-8"))
        path.unlink()
        path.write_text(source, "utf-8")


def mutant(bar: str, fault: str, file: str, old: str, new: str, *tests: str, hangs: bool = False) -> Mutant:
    """A mutant; what identifies its tests comes last."""
    return Mutant(bar, fault, file, old, new, tests, hangs)
