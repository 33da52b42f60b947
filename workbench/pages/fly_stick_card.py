"""The card of a branch: how it ended and what it was worth, beside the flight that it left."""

from __future__ import annotations

import html
import math
from pathlib import Path

from layouts.captions import clock_text, closest_miss_m, distance_text, outcome_text
from layouts.letters import branch_letter
from layouts.theme import BRANCH, missile_colour
from sim.trajectory import MissileTrack, Trajectory
from sim.world import Fate
from workbench.pages.fly_cards import CARD_CSS

BRANCH_CARD_CSS = CARD_CSS + Path(__file__).with_suffix(".css").read_text("utf-8")


def branch_card(of: str, original: Trajectory, branch: Trajectory, who: str) -> str:
    """The card as HTML: every figure of the branch, and after it, in grey, that of flight `of`.

    Args:
        of: letter of the flight that was left.
        original: that flight.
        branch: the branch.
        who: who flew from when on; may be any text.
    """
    cells = "".join(
        f"<div><dt>{name}</dt><dd>{value(branch)}<s title='flight {of}'>{of} {value(original)}</s></dd></div>"
        for name, value in NUMBERS.items()
    )
    fates = "".join(_missile(of, old, new) for old, new in zip(original.missiles, branch.missiles, strict=True))
    kind = "exit" if branch.success else "failed"
    return (
        f'<div class="card branch {kind}" style="--ink: {BRANCH}"><span class="letter">{branch_letter(of)}</span>'
        f'<div class="who"><div class="outcome">{outcome_text(branch)}<s>{of}: {outcome_text(original)}</s></div>'
        f'<div class="name" title="{html.escape(who)}">{html.escape(who)}</div><div class="fates">{fates}</div></div>'
        f'<dl class="numbers">{cells}</dl></div>'
    )


NUMBERS = {
    "duration": lambda flight: clock_text(flight.duration_s),
    "return": lambda flight: f"{flight.episode_return:.1f}",
    "evaded": lambda flight: f"{sum(m.fate is Fate.EVADED for m in flight.missiles)} of {len(flight.missiles)}",
    "closest": lambda flight: distance_text(closest_miss_m(flight)),
}
"""What the card tells of a flight, by the words it uses."""


def _missile(of: str, original: MissileTrack, branch: MissileTrack) -> str:
    """One missile's smallest distances; the same missile has the same number in both."""
    if math.isnan(original.closest_m) and math.isnan(branch.closest_m):
        return ""
    return (
        f'<span><i style="background: {missile_colour(branch.number)}"></i>{branch.number}: {_passed(branch)} '
        f"<s title='flight {of}'>{of} {_passed(original)}</s></span>"
    )


def _passed(track: MissileTrack) -> str:
    words = {Fate.UNLAUNCHED: "not launched", Fate.HIT: f"hit at {distance_text(track.closest_m)}"}
    return words.get(track.fate, distance_text(track.closest_m))
