"""The lines of the table of runs: what each says, as plain values that the browser only ever shows as text."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

from workbench.pages.runs_baseline import EXPERT_LABEL, expert_rate, expert_rate_of
from workbench.pages.runs_groups import Group, dots, grouped
from workbench.pages.runs_settings import EXPERT, NO_BASELINE, RunsSettings, group_key
from workbench.run_index.index import RunIndex
from workbench.run_index.record import RunRecord
from workbench.scenarios import DEFAULT, other_scenario
from workbench.terminal import duration

WINDOW = 120
"""Lines sent at a time."""
MARGIN = 40
"""Lines sent above what is in view."""
SIGNS = {
    "queued": "…", "running": "▶", "stalled": "!", "paused": "‖", "stopped": "■", "finished": "✓", "failed": "✗",
    "interrupted": "✗",
}  # fmt: skip
"""Signs before a state, so that it is seen without reading."""
TARGET = "1,2,3,4"


@dataclass(frozen=True)
class Listing:
    """What the table shows: a window of its lines, and what all of them are."""

    lines: list[dict[str, Any]] = field(default_factory=list)
    offset: int = 0
    """Number of the first line of the window."""
    total: int = 0
    """All lines."""
    runs: int = 0
    """All runs that were found."""
    everything: int = 0
    """All runs there are, found or not, in the trash or not as the view has it."""
    groups: dict[str, Group] = field(default_factory=dict)


def listing(index: RunIndex, settings: RunsSettings, first: int = 0) -> Listing:
    """The lines from about number `first` on."""
    search = settings.search
    offset = max(first - MARGIN, 0)
    everything = index.count(replace(search, text="", chosen={}))
    if settings.group:
        return replace(_grouped(index, settings, offset), everything=everything)
    runs = index.count(search)
    offset = min(offset, max(runs - WINDOW, 0))
    lines = [run_line(record, settings) for record in index.find(search, offset, WINDOW)]
    return Listing(lines, offset, runs, runs, everything)


def _grouped(index: RunIndex, settings: RunsSettings, offset: int) -> Listing:
    sort = settings.search.sort
    falling = sort.startswith("-") if sort.removeprefix("-") in ("success", "return") else None
    records = index.find(settings.search)
    groups = grouped(records, settings.group, falling)
    flat: list[Group | RunRecord] = []
    for group in groups:
        flat.append(group)
        if group.key in settings.opened:
            flat.extend(group.records)
    offset = min(offset, max(len(flat) - WINDOW, 0))
    window = flat[offset : offset + WINDOW]
    lines = [group_line(x, settings) if isinstance(x, Group) else run_line(x, settings) for x in window]
    return Listing(lines, offset, len(flat), len(records), groups={group.key: group for group in groups})


def group_line(group: Group, settings: RunsSettings) -> dict[str, Any]:
    """A group in one line: how many, and the interval of their success with a dot for every run."""
    key = group_key(group.key)
    interval = group.interval()
    value, low, high = interval or (math.nan,) * 3
    return {
        "kind": "group", "key": key, "label": group.key, "count": len(group.records),
        "open": group.key in settings.opened, "slot": _slot(key, settings), "dots": dots(group.successes),
        "base": expert_rate_of(group.records[0]) if settings.baseline == EXPERT else None,
        "value": _number(value), "low": _number(low), "high": _number(high),
        "success": _interval_words(value, low, high),
    }  # fmt: skip


def _number(value: float) -> float | None:
    return None if math.isnan(value) else round(value, 5)


def _interval_words(value: float, low: float, high: float) -> str:
    if math.isnan(value):
        return "–"
    bounds = "" if math.isnan(low) else f"  {100 * low:.1f}–{100 * high:.1f}"
    return f"{100 * value:.1f} %{bounds}"


def run_line(record: RunRecord, settings: RunsSettings) -> dict[str, Any]:
    """A run in one line; a damaged one says what is wrong with it."""
    line = {
        "kind": "run", "key": record.id, "slot": _slot(record.id, settings),
        "state": record.state, "sign": SIGNS.get(record.state, "✗" if record.problem else "•"),
        "tags": record.tag_list, "note": record.notes[:300], "pinned": record.id == settings.baseline,
    }  # fmt: skip
    if record.problem:
        return {**line, "name": record.id, "problem": record.problem}
    return {
        **line,
        "problem": "",
        "error": record.error,
        "name": record.name or record.id,
        **_figures(record, settings),
    }


def _figures(record: RunRecord, settings: RunsSettings) -> dict[str, Any]:
    gap = _over_baseline(record, settings)
    return {
        "task": " · ".join(filter(None, [record.task, other_scenario(record.scenario)])),
        "variant": record.variant,
        "profile": record.profile,
        "seed": str(record.seed),
        "value": record.success,
        "success": "–" if record.success is None else f"{100 * record.success:.1f} %",
        "gap": "" if gap is None else f"{100 * gap:+.1f}".replace("-", "−"),
        "return": "–" if record.mean_return is None else f"{record.mean_return:.0f}".replace("-", "−"),
        "progress": round(record.progress, 3),
        "steps": _count_words(record.steps),
        "time": duration(record.wall_s) if record.wall_s else "–",
        "started": record.when[:16].replace("T", " "),
    }


def _over_baseline(record: RunRecord, settings: RunsSettings) -> float | None:
    """By how much a run's success is over the expert's on its task; nothing is said against a pinned run."""
    rate = expert_rate_of(record) if settings.baseline == EXPERT else None
    return None if rate is None or record.success is None else record.success - rate


def _count_words(count: int | None) -> str:
    if count is None:
        return "–"
    return f"{count / 1e6:.2f} M" if count >= 1_000_000 else f"{count / 1e3:.0f} k"


def _slot(key: str, settings: RunsSettings) -> int:
    return settings.shown.index(key) if key in settings.shown else -1


def baseline_line(settings: RunsSettings, record: RunRecord | None) -> dict[str, Any] | None:
    """The pinned line above all others; None where nothing is pinned, or the pinned run has gone."""
    if settings.baseline == NO_BASELINE or (settings.baseline != EXPERT and record is None):
        return None
    if record is not None:
        return {**run_line(record, settings), "kind": "pinned"}
    task, rate = expert_rate(DEFAULT, TARGET)
    return {
        "kind": "pinned", "key": EXPERT, "name": EXPERT_LABEL, "state": "baseline", "sign": "", "tags": [], "slot": -1,
        "task": f"{task} task", "variant": "rule", "value": rate,
        "success": "–" if rate is None else f"{100 * rate:.1f} %",
        "problem": "", "note": "",
    }  # fmt: skip
