"""The list at the side of the Live page: what is being trained, what has just ended, and whose curves are drawn."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.run_curves import RUN_INKS
from layouts.theme import NEUTRAL
from workbench.pages.live_cards import STATE_COLOURS
from workbench.pages.live_settings import LiveSettings
from workbench.pages.live_words import outcome
from workbench.run_index.index import RunIndex
from workbench.run_index.query import RunSearch
from workbench.run_index.record import RunRecord
from workbench.run_state import ACTIVE

MOST_ALIVE, MOST_ENDED = 40, 14


class LiveList(JSComponent):
    """Runs to walk through; a click opens one, its box lays its curves beside those of the opened one."""

    lines = param.String(default="[]", doc="JSON: dicts as `list_lines` makes them; every text is shown as text")
    asked = param.List(default=["", "", 0], doc="what was asked of which run, and a count; set by the browser")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


def listed(index: RunIndex, settings: LiveSettings) -> list[RunRecord]:
    """Runs under way, oldest first, then those that ended last, then what is open and in neither."""
    alive = index.find(RunSearch(chosen={"state": ACTIVE}), most=MOST_ALIVE)
    recent = index.find(RunSearch(), most=MOST_ALIVE + MOST_ENDED)
    ended = [record for record in recent if record.state not in ACTIVE and not record.problem][:MOST_ENDED]
    found = [*reversed(alive), *ended]
    known = {record.id for record in found}
    others = [index.get(each) for each in (settings.run, *settings.beside) if each and each not in known]
    return [*found, *(record for record in others if record is not None and not record.problem)]


def list_lines(records: Sequence[RunRecord], settings: LiveSettings) -> str:
    """What `LiveList` shows."""
    drawn = [settings.run, *settings.beside]
    return json.dumps([_line(record, settings, drawn) for record in records])


def _line(record: RunRecord, settings: LiveSettings, drawn: list[str]) -> dict[str, Any]:
    seed = "" if record.seed is None else f"seed {record.seed}"
    alive = record.state in ACTIVE
    several = len(drawn) > 1 and record.id in drawn
    return {
        "id": record.id,
        "title": record.title,
        "detail": " · ".join(filter(None, (record.variant, record.profile, seed))),
        "state": record.state,
        "ink": STATE_COLOURS.get(record.state, NEUTRAL),
        "alive": alive,
        "share": record.progress,
        "words": _words(record, alive),
        "open": record.id == settings.run,
        "beside": record.id in settings.beside,
        "curve": RUN_INKS[drawn.index(record.id) % len(RUN_INKS)] if several else "",
    }


def _words(record: RunRecord, alive: bool) -> str:
    if alive or record.state == "paused":
        return f"{100 * record.progress:.0f} %" if record.progress else ("waits" if record.state == "queued" else "0 %")
    return "–" if record.success is None else f"{100 * record.success:.1f} %"


def watched_json(records: Sequence[RunRecord]) -> str:
    """The runs whose end is news, and what is then said."""
    told = [
        {"id": each.id, "title": each.title, "state": each.state, "words": outcome(each.state, each.success)}
        for each in records
    ]
    return json.dumps(told)
