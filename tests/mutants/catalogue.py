"""Every mutant, in the order of the bars; `python scripts/mutants.py` runs them."""

from __future__ import annotations

from typing import Final

from tests.mutants.cluster import CLUSTER
from tests.mutants.contents import CONTENTS
from tests.mutants.door import DOOR
from tests.mutants.mutant import Mutant
from tests.mutants.running import RUNNING
from tests.mutants.saving import SAVING

BEFORE_RELEASE: Final = frozenset(
    [
        *(f"R{number}" for number in (*range(1, 13), 14, 15, 18)),
        *(f"S{number}" for number in (*range(1, 14), 16, 17)),
        *(f"C{number}" for number in range(1, 5)),
    ]
)
"""Bars that must hold before a release; each has a mutant."""


def _order(each: Mutant) -> tuple[str, int]:
    return each.bar[0], int(each.bar[1:])


MUTANTS: Final = tuple(sorted((*SAVING, *RUNNING, *DOOR, *CONTENTS, *CLUSTER), key=_order))
