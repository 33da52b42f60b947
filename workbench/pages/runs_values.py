"""What the bar and the table of the Runs page are told for one view."""

from __future__ import annotations

import json
from typing import Any

from workbench.pages.runs_settings import RunsSettings
from workbench.pages.runs_view import RunsList

NO_RUNS = "No run yet. Launch one on the Curriculum page, or in a terminal: workbench train --curriculum"
NONE_FOUND = "No run fits. Take words out of the search, or choose “Clear filters”."
NO_TRASH = "The trash is empty. Deleted runs come here, and stay until “workbench runs empty-trash”."


def bar_values(settings: RunsSettings, listed: RunsList | None, reading: tuple[int, int] | None) -> dict[str, Any]:
    """Values of the bar; `reading` is how many run folders of how many have been read, where it takes long."""
    search = settings.search
    values = {
        "text": search.text,
        "chosen": {name: list(each) for name, each in search.chosen.items()},
        "group": settings.group,
        "trash": search.trashed,
        "ticked": len(settings.shown_runs),
        "counted": _counted(listed, reading),
    }
    return values if listed is None else {**values, "facets": json.dumps(listed.facets)}


def _counted(listed: RunsList | None, reading: tuple[int, int] | None) -> str:
    if reading is not None:
        return f"reading run folders: {reading[0]} of {reading[1]} …"
    if listed is None:
        return "opening the index of the runs …"
    found, everything = listed.listing.runs, listed.listing.everything
    return f"{found} run{'s' * (found != 1)}" if found == everything else f"{found} of {everything} runs"


def table_values(settings: RunsSettings, listed: RunsList | None) -> dict[str, Any]:
    """Values of the table."""
    values: dict[str, Any] = {"sort": settings.search.sort, "focused": settings.run}
    if listed is None:
        return values
    lines = listed.listing
    return {
        **values,
        "lines": json.dumps(lines.lines),
        "offset": lines.offset,
        "total": lines.total,
        "pinned": json.dumps(listed.pinned),
        "empty": NONE_FOUND if lines.everything else NO_TRASH if settings.search.trashed else NO_RUNS,
    }
