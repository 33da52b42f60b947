"""One card per flight: who flew, how it ended, and the numbers that matter."""

from __future__ import annotations

import html
from pathlib import Path

from layouts.captions import clock_text, closest_miss_m, distance_text, outcome_text
from sim.trajectory import Trajectory
from sim.world import Fate, Outcome

CARD_CSS = Path(__file__).with_suffix(".css").read_text("utf-8")


def flight_card(letter: str, label: str, flight: Trajectory, colour: str) -> str:
    """The card as HTML; `label` may be any text."""
    fates = [track.fate for track in flight.missiles]
    numbers = {
        "duration": clock_text(flight.duration_s),
        "return": f"{flight.episode_return:.1f}",
        "evaded": f"{sum(fate is Fate.EVADED for fate in fates)} of {len(fates)}",
        "closest miss" if flight.outcome is not Outcome.SHOT_DOWN else "closest": distance_text(closest_miss_m(flight)),
    }
    cells = "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in numbers.items())
    kind = "exit" if flight.success else "failed"
    return (
        f'<div class="card {kind}" style="--ink: {colour}"><span class="letter">{letter}</span><div class="who">'
        f'<div class="outcome">{outcome_text(flight)}</div><div class="name" title="{html.escape(label)}">'
        f'{html.escape(label)}</div></div><dl class="numbers">{cells}</dl></div>'
    )


def note_card(letter: str, label: str, colour: str, note: str) -> str:
    """The card while there is no flight to tell of."""
    return (
        f'<div class="card" style="--ink: {colour}"><span class="letter">{letter}</span><div class="who">'
        f'<div class="outcome">{html.escape(note)}</div><div class="name">{html.escape(label)}</div></div></div>'
    )
