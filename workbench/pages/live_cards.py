"""Colours of states and events, and a run's events as HTML. Every text of a run is escaped."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

from layouts.theme import FAILURE, NEUTRAL, POLICY_A, POLICY_B, SUCCESS
from workbench.terminal import duration

Row = Mapping[str, Any]

STATE_COLOURS = {
    "queued": NEUTRAL,
    "running": POLICY_A,
    "stalled": FAILURE,
    "paused": POLICY_B,
    "stopped": POLICY_B,
    "finished": SUCCESS,
    "failed": FAILURE,
    "interrupted": FAILURE,
}
EVENT_COLOURS = {
    "stage_started": POLICY_A,
    "resumed": POLICY_A,
    "best": SUCCESS,
    "promoted": SUCCESS,
    "stage_finished": SUCCESS,
    **STATE_COLOURS,
}
MOST_EVENTS = 300
"""Events that are listed: the newest."""

EVENTS_CSS = """
:host { color: var(--panel-on-background-color); font: 13px/1.4 var(--bokeh-base-font, sans-serif) }
h2 { font-size: 13px; font-weight: 650; margin: 0 0 5px }
.events { max-height: 330px; overflow-y: auto; scrollbar-width: thin }
@media (max-width: 1180px) { .events { max-height: 168px } }
.events:focus-visible { outline: 3px solid #2f86ff }
.event { display: grid; grid-template-columns: 44px 8px 1fr; gap: 8px; align-items: baseline; padding: 2px 0 }
.event time { text-align: right; opacity: .8; font-variant-numeric: tabular-nums }
.dot { width: 8px; height: 8px; border-radius: 50%; background: var(--ink) }
.text { overflow-wrap: anywhere }
"""


def event_list(events: Sequence[Row]) -> str:
    """The run's latest events, the newest first."""
    rows = []
    for event in reversed(events[-MOST_EVENTS:]):
        ink = EVENT_COLOURS.get(str(event.get("kind")), NEUTRAL)
        when, text = event.get("wall_s"), html.escape(str(event.get("text", "")))
        stamp = duration(when) if isinstance(when, int | float) else "–"
        rows.append(
            f'<div class="event"><time>{stamp}</time><span class="dot" style="--ink: {ink}"></span>'
            f'<span class="text">{text}</span></div>'
        )
    listed = "".join(rows) or "No event yet."
    return (
        f'<h2>What has happened</h2><div class="events" tabindex="0" role="region" aria-label="Events">{listed}</div>'
    )
