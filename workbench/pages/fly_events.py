"""What happened in both flights, in order: launches, closest approaches, evasions, and how each ended."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import BRANCH, FAILURE, NEUTRAL, SUCCESS, missile_colour
from sim.trajectory import Event, Trajectory

ENDINGS = {"exit": SUCCESS, "shot_down": FAILURE, "left_field": FAILURE, "timeout": NEUTRAL, "branch": BRANCH}


class EventList(JSComponent):
    """Rows that move the page's clock when clicked; rows ahead of the clock are dim."""

    events = param.List(default=[], doc="rows: dicts as `event_rows` makes them")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


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
