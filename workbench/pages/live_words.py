"""How a run stands, in one sentence, and what can be done about it; also for a tab, a notification, a screen reader."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.queue_place import QueuePlace
from workbench.run_state import RunState
from workbench.terminal import duration, percent

DEFAULT_FOLDER = "runs"
SOON_S = 10.0
"""What is sooner is not counted."""


@dataclass(frozen=True)
class Wish:
    """What was asked of a run and has not happened yet."""

    pause: bool = False
    stop: bool = False


def now_words(state: RunState, row: Mapping[str, Any] | None, place: QueuePlace | None = None) -> str:
    """Where the training is, and of a waiting one its `place` in the queue."""
    if state.state == "queued":
        return f"waits for a free core{_place_words(place)}" if not state.engine else "waits for a node of its cluster"
    if row is None:
        return "starting: the first epoch is under way" if state.state == "running" else "no epoch was finished"
    stage = f"stage {row['stage'] + 1} of {row['stages']} · " if row["stages"] > 1 else ""
    return f"{stage}{row['task']} · epoch {row['epoch']} of at most {row['epochs']}"


def _place_words(place: QueuePlace | None) -> str:
    if place is None:
        return ""
    nth = {1: "the next", 2: "the second", 3: "the third"}.get(place.place, f"number {place.place}")
    words = f", {nth} of {place.waiting} in the queue" if place.waiting > 1 else ", the only one in the queue"
    if place.starts_s is None:
        return words
    when = f"in about {duration(place.starts_s)}" if place.starts_s >= SOON_S else "soon"
    return f"{words}; starts {when}"


def advice(state: RunState, wish: Wish) -> str:
    """What happened and what to do, in a sentence or two; empty while it simply learns."""
    done = percent(state.progress) if state.progress else "0 %"
    if state.state == "running" and wish.stop:
        return "It stops at the end of this epoch; its best policy is judged on fresh episodes first."
    if state.state == "running" and wish.pause:
        return "It pauses at the end of this epoch, when everything it goes on from is saved."
    return {
        "queued": f"It starts by itself as soon as a {'node' if state.engine else 'core'} is free; pausing or stopping "
        "takes it out of the queue.",
        "stalled": "Its process lives but has given no sign for long. A machine that slept recovers by itself; else "
        "end the process and resume from the last checkpoint.",
        "paused": f"Paused with {done} done, and everything is saved. Resume it and it goes on bit for bit.",
        "stopped": f"Stopped by hand with {done} done; its best policy is kept. Fly it, or resume the training.",
        "failed": f"It failed with {done} done: {state.error or 'no reason was given'}. Resume goes on from the last "
        "checkpoint; if it fails there again, the end of its log says more.",
        "interrupted": f"Its process ended without a word with {done} done: the machine went down, or somebody "
        "killed it. Resume goes on from the last checkpoint.",
        "finished": f"Finished after {duration(state.wall_s)} of work. Fly its policy, compare it, or look back at how "
        "it learned.",
    }.get(state.state, "")  # fmt: skip


def command(state: RunState, run_id: str, folder: Path) -> str:
    """What to type in a terminal to let the run go on; empty where there is nothing to resume."""
    if not (state.resumable or state.state == "stalled"):
        return ""
    name = "resume" if state.resumable else "stop"
    option = "" if folder == Path(DEFAULT_FOLDER).absolute() else f" --runs {shlex.quote(str(folder))}"
    return f"workbench {name} {run_id}{' --now' if name == 'stop' else ''}{option}"


def tab_title(state: RunState) -> str:
    """What the browser's tab is called: `62 % · target · SubMas`."""
    head = f"{100 * state.progress:.0f} %" if state.state == "running" else state.state
    return " · ".join(filter(None, (head, state.task, "SubMas")))


def spoken(state: RunState, wish: Wish, title: str) -> str:
    """The same for a screen reader; changes only when there is news: at every tenth of the way, stage and state."""
    if state.state != "running":
        return f"{title}: {advice(state, wish)}"
    if wish.stop or wish.pause:
        return f"{title}: {advice(state, wish)}"
    stage = f", stage {state.stage + 1} of {state.stages}" if state.stages > 1 else ""
    return f"{title}: running{stage}, {state.task}, {10 * int(10 * state.progress)} percent done"


def outcome(state: str, success: float | None) -> str:
    """How a run ended, for a notification."""
    rate = "" if success is None else f": {percent(success)} held-out success"
    return {
        "finished": f"finished{rate}",
        "paused": "paused; resume it on the Live page",
        "stopped": f"stopped{rate}",
        "failed": "failed; the Live page says why",
        "interrupted": "its process ended; resume it on the Live page",
        "stalled": "gives no sign any more; the Live page says what to do",
    }.get(state, state)
