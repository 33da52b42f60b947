"""What flights are called and which ink their evaders have, wherever several are shown together."""

from __future__ import annotations

from collections.abc import Sequence

from layouts.theme import BRANCH, POLICY_A, POLICY_B, missile_colour
from sim.trajectory import Trajectory

LETTERS = "ABCDEFGH"


def letters(flights: Sequence[Trajectory]) -> tuple[str, ...]:
    """A, B … from left to right, a branch after the flight that it left: B′; nothing for a flight that is alone."""
    if len(flights) == 1:
        return ("",)
    return tuple(
        branch_letter(flight.departure.of) if flight.departure else LETTERS[number]
        for number, flight in enumerate(flights)
    )


def branch_letter(of: str) -> str:
    """How a branch of flight `of` is called: A′ or B′."""
    return f"{of}′"


def evader_inks(flights: Sequence[Trajectory]) -> tuple[str, ...]:
    """`#rrggbb` of each flight's evader; of a flight that is alone, the first policy's."""
    own = (POLICY_A, POLICY_B, *map(missile_colour, range(2, len(flights))))
    branches = [len(flights) > 1 and flight.departure is not None for flight in flights]
    return tuple(BRANCH if branch else ink for ink, branch in zip(own, branches, strict=False))
