"""What each stage of a training has reached, from its metrics, and how it ended, from its events."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


def summarise(rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Each begun stage: `task`, best held-out `success_rate` (0..1 or None), `epochs`, working time `wall_s` [s].

    Args:
        rows: metrics rows of a run, oldest first.
    """
    stages: dict[int, dict[str, Any]] = {}
    for row in rows:
        fresh = {"task": row["task"], "success_rate": None, "epochs": 0, "wall_s": 0.0}
        stage = stages.setdefault(row["stage"], fresh)
        rates = [rate for rate in (stage["success_rate"], row.get("success_rate")) if rate is not None]
        # The learner's clock starts anew with every stage.
        stage.update(epochs=row["epoch"], success_rate=max(rates, default=None), wall_s=row.get("wall_s") or 0.0)
    return [stages[number] for number in sorted(stages)]


def end_of(events: Iterable[Mapping[str, Any]], task: str) -> Mapping[str, Any] | None:
    """The event that says how the stage of `task` ended, the last one if it ended more than once; None before."""
    ended = [event for event in events if event.get("kind") == "stage_finished" and event.get("task") == task]
    return ended[-1] if ended else None


def promoted(end: Mapping[str, Any]) -> bool:
    """Whether a stage ended because its policy passed, and not because its epochs ran out."""
    return "held-out evaluations" in str(end.get("reason", ""))
