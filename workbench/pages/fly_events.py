"""What happened in both flights, in order: launches, closest approaches, evasions, and how each ended."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import FAILURE, NEUTRAL, SUCCESS, missile_colour
from sim.trajectory import Event, Trajectory

ENDINGS = {"exit": SUCCESS, "shot_down": FAILURE, "left_field": FAILURE, "timeout": NEUTRAL}


class EventList(JSComponent):
    """Rows that move the page's clock when clicked; rows ahead of the clock are dim."""

    events = param.List(default=[], doc="rows: dicts as `event_rows` makes them")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        """
.events { display: flex; flex-direction: column; height: 100%; overflow-y: auto; scrollbar-width: thin; gap: 1px;
  font: 13px/1.3 var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color) }
button { display: grid; grid-template-columns: 40px 20px 8px 1fr; gap: 8px; align-items: center; text-align: left; font: inherit;
  color: inherit; background: none; border: 0; border-left: 3px solid transparent; padding: 5px 6px 5px 5px; cursor: pointer;
  border-radius: 0 4px 4px 0 }
button:hover { background: color-mix(in srgb, currentColor 9%, transparent) }
button:focus-visible { outline: 2px solid var(--panel-primary-color); outline-offset: -2px }
.future { opacity: .5 }
.latest { border-left-color: var(--panel-primary-color); background: color-mix(in srgb, currentColor 6%, transparent) }
.when { font-variant-numeric: tabular-nums; text-align: right; opacity: .8 }
.who { color: #fff; border-radius: 4px; text-align: center; font-weight: 700; font-size: 11px; line-height: 18px }
.dot { width: 8px; height: 8px; border-radius: 50% }
.exit .what, .shot_down .what, .left_field .what, .timeout .what { font-weight: 700 }
"""
    ]


def event_rows(flights: Mapping[str, Trajectory], colours: Mapping[str, str]) -> list[dict[str, Any]]:
    """Rows of the list by time: `time` [s], `who` (the flight's letter), `kind`, `text`, and two colours."""
    rows = [
        {
            "time": round(event.time_s, 2),
            "who": who,
            "who_colour": colours[who],
            "kind": event.kind,
            "colour": event_colour(event),
            "text": event.text,
        }
        for who, flight in flights.items()
        for event in flight.events
    ]
    return sorted(rows, key=lambda row: (row["time"], row["who"]))


def event_colour(event: Event) -> str:
    """Colour of the missile concerned, or of the ending."""
    return ENDINGS.get(event.kind) or missile_colour(event.missile)
