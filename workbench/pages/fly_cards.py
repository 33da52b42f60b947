"""One card per flight: who flew, how it ended, and the numbers that matter."""

from __future__ import annotations

import html
import math

from sim.trajectory import Trajectory
from sim.world import Fate, Outcome

CARD_CSS = """
:host { --ok: #1fa05f; --bad: #e5414d; --idle: #7d8794 }
.card { display: flex; align-items: center; gap: 14px; padding: 8px 14px 8px 10px; border-radius: 8px; min-height: 48px;
  border-left: 5px solid var(--ink); font-family: var(--bokeh-base-font, sans-serif); box-sizing: border-box; height: 100%;
  background: color-mix(in srgb, var(--ink) 9%, transparent); color: var(--panel-on-background-color) }
.letter { font-size: 26px; font-weight: 800; color: var(--ink); width: 22px; text-align: center; flex: none }
.who { flex: 1 1 120px; min-width: 0; line-height: 1.25 }
.name { font-size: 13px; opacity: .8; white-space: nowrap; overflow: hidden; text-overflow: ellipsis }
.outcome { font-size: 17px; font-weight: 650; white-space: nowrap; overflow: hidden; text-overflow: ellipsis }
.exit .outcome { color: var(--ok) } .failed .outcome { color: var(--bad) }
.numbers { display: flex; gap: 18px; margin: 0; text-align: right; flex: none }
.numbers div { display: flex; flex-direction: column-reverse }
.numbers dt { font-size: 11px; opacity: .7; white-space: nowrap }
.numbers dd { margin: 0; font-size: 17px; font-weight: 600; font-variant-numeric: tabular-nums; white-space: nowrap }
"""


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


def waiting_card(letter: str, label: str, colour: str) -> str:
    """The card before the first flight is there."""
    return (
        f'<div class="card" style="--ink: {colour}"><span class="letter">{letter}</span><div class="who">'
        f'<div class="outcome">flying …</div><div class="name">{html.escape(label)}</div></div></div>'
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
