"""The head of the Live page: how the run stands, how long it still takes, and the buttons that act on it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import FILLED_CSS
from workbench.pages.live_cards import STATE_COLOURS
from workbench.pages.live_words import Wish, advice, command, now_words, spoken, tab_title
from workbench.policies import title
from workbench.queue_place import QueuePlace
from workbench.run_state import RunState
from workbench.runs import Run
from workbench.scenarios import other_scenario

LOG_LINES = 12


class LiveHead(JSComponent):
    """What it is told is shown as text; what a button asks for is one value that Python hears of."""

    facts = param.String(default="{}", doc="JSON: a dict as `head_facts` makes it; empty for no run")
    watched = param.String(default="[]", doc="JSON: dicts of id, title, state and words, of runs whose end is news")
    asked = param.List(default=["", 0], doc="what a button asked for, and a count; set by the browser")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [FILLED_CSS + Path(__file__).with_suffix(".css").read_text("utf-8")]


def head_facts(
    run: Run, state: RunState, last: dict[str, Any] | None, likely_s: float | None, fly: str, newest: str,
    place: QueuePlace | None = None,
) -> str:  # fmt: skip
    """What `LiveHead` shows of a run.

    Args:
        run: the run.
        state: how it stands.
        last: its latest metrics row.
        likely_s: how long trainings like this usually take [s], where that is known.
        fly: address of its newest policy; empty while it has none.
        newest: which policy that is.
        place: of a waiting run, its place in the queue.
    """
    wish = Wish(run.pause_requested(), run.stop_requested()) if state.state in ("running", "stalled") else Wish()
    name = title(run.config)
    facts = {
        "id": run.id,
        "title": name,
        "scenario": other_scenario(run.config.scenario),
        "state": state.state,
        "ink": STATE_COLOURS[state.state],
        "now": now_words(state, last, place),
        "where": f"on {state.where}" if state.engine and state.node else "",
        "advice": advice(state, wish),
        "error": state.error,
        "progress": state.progress,
        "worked_s": state.wall_s,
        "most_s": state.eta_s if state.state == "running" else None,
        "likely_s": _left(likely_s, state),
        "resumes": state.resumes,
        "buttons": _buttons(state, wish),
        "fly": fly,
        "newest": newest,
        "command": command(state, run.id, run.path.parent),
        "log": run.log_tail(LOG_LINES) if state.state in ("failed", "interrupted", "stalled") else "",
        "tab": tab_title(state),
        "said": spoken(state, wish, name),
    }
    return json.dumps(facts)


def _left(likely_s: float | None, state: RunState) -> float | None:
    """Usual time left [s], while it says more than the most it can take."""
    if likely_s is None or state.state != "running" or likely_s <= state.wall_s:
        return None
    left = likely_s - state.wall_s
    return left if state.eta_s is None or left < 0.95 * state.eta_s else None


def _buttons(state: RunState, wish: Wish) -> dict[str, dict[str, Any]]:
    """The buttons that make sense, by what they ask for: label, and whether they can be pressed now."""
    if state.state == "stalled":
        return {"kill": {"label": "End its process"}}
    if state.active:
        waiting = wish.pause or wish.stop
        return {
            "pause": {"label": "Pausing …" if wish.pause and not wish.stop else "Pause", "off": waiting},
            "stop": {"label": "Stopping …" if wish.stop else "Stop", "off": wish.stop},
        }
    return {"resume": {"label": "Resume"}} if state.resumable else {}
