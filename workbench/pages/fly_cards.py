"""One card per flight: who flew, how it ended, and the numbers that matter."""

from __future__ import annotations

import html
import math
from pathlib import Path

from sim.trajectory import Trajectory
from sim.world import Fate, Outcome

CARD_CSS = Path(__file__).with_suffix(".css").read_text("utf-8")


def flight_card(letter: str, label: str, flight: Trajectory, colour: str) -> str:
    """The card as HTML; `label` may be any text."""
    fates = [track.fate for track in flight.missiles]
    closest = min((m.closest_m for m in flight.missiles if not math.isnan(m.closest_m)), default=math.nan)
    numbers = {
        "duration": clock_text(flight.duration_s),
        "return": f"{flight.episode_return:.1f}",
        "evaded": f"{sum(fate is Fate.EVADED for fate in fates)} of {len(fates)}",
        "closest miss" if flight.outcome is not Outcome.SHOT_DOWN else "closest": distance_text(closest),
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


def outcome_text(flight: Trajectory) -> str:
    """How a flight ended, and the cause when it failed."""
    texts = {
        Outcome.EXIT: "✓ Reached the exit",
        Outcome.SHOT_DOWN: f"✗ Shot down by missile {flight.killer}",
        Outcome.LEFT_FIELD: "✗ Left the battlefield",
        Outcome.TIMEOUT: "✗ Out of time",
    }
    return texts.get(flight.outcome, "still flying")


def clock_text(seconds: float) -> str:
    """Minutes and seconds, as on the clock."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def distance_text(metres: float) -> str:
    """Metres below a kilometre, kilometres above; a dash for none."""
    if math.isnan(metres):
        return "–"
    return f"{metres:.0f} m" if metres < 1000.0 else f"{metres / 1e3:.1f} km"
