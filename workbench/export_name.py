"""Names of files that a page hands out: which flights are inside, and of a branch from when on and who flew it."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sim.trajectory import Departure, Trajectory

LONGEST = 60
"""Characters of a policy's name that a file's name keeps."""


def export_name(flights: Sequence[Trajectory], who: str, suffix: str) -> str:
    """As in `flight-2.html`, `flight-2-A.csv`, `flight-2-B-from-330s-by-hand-then-submas-target.gif`.

    Args:
        flights: what is inside.
        who: letter of the one flight that is inside; empty for several.
        suffix: of the format.
    """
    branch = next((flight.departure for flight in flights if flight.departure), None)
    episode = f"-{flights[0].episode}" if flights[0].episode else ""
    rest = f"-{_branch_words(branch)}" if branch else f"-{who}" * bool(who)
    together = "-with" if branch and len(flights) > 1 else ""
    return f"flight-{flights[0].seed}{episode}{together}{rest}{suffix}"


def _branch_words(left: Departure) -> str:
    flown = ["by-hand"] * bool(left.headings_deg) + [_plain(left.then)] * bool(left.then)
    return f"{left.of}-from-{left.time_s:g}s-{'-then-'.join(flown)}"


def _plain(name: str) -> str:
    """Letters, digits, dots and dashes: what no system takes for something else."""
    return re.sub(r"[^A-Za-z0-9.]+", "-", name).strip("-.")[:LONGEST] or "policy"
