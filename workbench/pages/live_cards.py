"""A run in numbers, as HTML: its state, its stages, its latest figures, its events. Every text of a run is escaped."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from typing import Any

from layouts.theme import FAILURE, NEUTRAL, POLICY_A, POLICY_B, SUCCESS
from workbench.run_state import RunState
from workbench.terminal import duration, percent

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
NUMBERS = {
    "alpha": ("α", "distillation weight (Eq. 16, 20)", 3),
    "epsilon": ("ε", "reuse probability (Eq. 19, 21)", 3),
    "beta": ("β", "success rate that moves α and ε", 3),
    "transfer_share": ("transfer", "share of steps on which the transfer mask allowed transfer (Eq. 13)", 3),
    "critic_loss": ("critic loss", "latest epoch", 4),
    "actor_loss": ("actor loss", "latest epoch", 3),
    "q_mean": ("mean Q", "latest epoch", 2),
    "updates_per_s": ("updates/s", "gradient steps per second", 0),
    "env_steps_per_s": ("env-steps/s", "decision steps per second, all lanes together", 0),
}
"""Figures of a metrics row: how they are called, what they are, and their decimals."""

LIVE_CSS = """
:host { color: var(--panel-on-background-color); font: 14px/1.4 var(--bokeh-base-font, sans-serif) }
.head { display: flex; align-items: baseline; gap: 12px; flex-wrap: wrap }
.state { color: #fff; background: var(--ink); border-radius: 6px; padding: 2px 10px; font-weight: 650 }
.now { font-size: 17px; font-weight: 650 }
.quiet { opacity: .7; font-size: 13px }
.error { color: #e5414d; font-weight: 600; flex-basis: 100%; overflow-wrap: anywhere }
.stages { display: flex; gap: 10px; flex-wrap: wrap }
.stage { flex: 1 1 150px; border-radius: 10px; padding: 8px 12px; border: 1.5px solid var(--ink);
  background: linear-gradient(var(--ink) 0 0) 0 100%/var(--share, 0) 4px no-repeat,
  color-mix(in srgb, var(--ink) 12%, transparent) }
.stage b { display: block; font-size: 14.5px }
.stage .big { font-size: 20px; font-weight: 700; font-variant-numeric: tabular-nums }
.stage.waiting { border-style: dashed; opacity: .6 }
.numbers { display: grid; grid-template-columns: repeat(auto-fit, minmax(82px, 1fr)); gap: 8px 14px; margin: 0 }
.numbers div { display: flex; flex-direction: column-reverse }
.numbers dt { font-size: 12px; opacity: .7; white-space: nowrap }
.numbers dd { margin: 0; font-size: 18px; font-weight: 650; font-variant-numeric: tabular-nums; white-space: nowrap }
.events { height: 100%; overflow-y: auto; scrollbar-width: thin; font-size: 13px }
.event { display: grid; grid-template-columns: 52px 8px 1fr; gap: 9px; align-items: baseline; padding: 3px 0 }
.event time { text-align: right; opacity: .7; font-variant-numeric: tabular-nums }
.dot { width: 8px; height: 8px; border-radius: 50%; background: var(--ink) }
.text { overflow-wrap: anywhere }
"""


def head(state: RunState, row: Row | None, scenario: str = "") -> str:
    """State, where the training is, how long it can still take, and the scenario where it has to be said."""
    ink = STATE_COLOURS[state.state]
    words = [f'<span class="state" style="--ink: {ink}">{state.state}</span>']
    if state.state == "queued":
        words.append('<span class="now">waits for a free core</span>')
    elif row is None:
        text = "starting" if state.state == "running" else "no epoch was finished"
        words.append(f'<span class="now">{text}</span>')
    else:
        stage = f"stage {row['stage'] + 1} of {row['stages']} · " if row["stages"] > 1 else ""
        epoch = f"epoch {row['epoch']} of at most {row['epochs']}"
        words.append(f'<span class="now">{stage}{html.escape(str(row["task"]))} · {epoch}</span>')
    if scenario:
        words.append(f'<span class="quiet">scenario <b>{html.escape(scenario)}</b></span>')
    words.append(f'<span class="quiet">{duration(state.wall_s)} worked{_left(state)}</span>')
    if state.error:
        words.append(f'<span class="error">{html.escape(state.error)}</span>')
    return f'<div class="head">{"".join(words)}</div>'


def _left(state: RunState) -> str:
    return f", at most {duration(state.eta_s)} left" if state.state == "running" and state.eta_s is not None else ""


def stage_cards(tasks: Sequence[str], learned: Sequence[Row], state: RunState, row: Row | None) -> str:
    """One chip per stage: its task, the best held-out success so far, its epochs and its time.

    Args:
        tasks: names of the tasks of all stages, in order.
        learned: what each begun stage has reached, as `workbench.stages.summarise` has it.
        state: how the run stands.
        row: the latest metrics row.
    """
    chips = [_begun(stage, SUCCESS) for stage in learned[:-1]]
    if learned and row is not None:
        chips.append(_latest(learned[-1], state, row))
    elif state.state == "running" and tasks:
        chips.append(_stage("begun", POLICY_A, tasks[0], "–", "first epoch"))
    chips += [_stage("waiting", NEUTRAL, task, "–", "waits") for task in tasks[len(chips) :]]
    return f'<div class="stages">{"".join(chips)}</div>'


def _begun(stage: Row, ink: str, left: str = "", share: float = 1.0) -> str:
    epochs = f"{stage['epochs']} epoch{'s' * (stage['epochs'] != 1)} · {duration(stage['wall_s'])}{left}"
    return _stage("begun", ink, str(stage["task"]), percent(stage["success_rate"]), epochs, share)


def _latest(stage: Row, state: RunState, row: Row) -> str:
    share = min(row["epoch"] / max(row["epochs"], 1), 1.0)
    if state.state != "running":
        return _begun(stage, STATE_COLOURS[state.state], share=1.0 if state.state == "finished" else share)
    left_s = stage["wall_s"] / max(row["epoch"], 1) * (row["epochs"] - row["epoch"])
    return _begun(stage, POLICY_A, f", at most {duration(left_s)} left", share)


def _stage(kind: str, ink: str, task: str, success: str, words: str, share: float = 0.0) -> str:
    return (
        f'<div class="stage {kind}" style="--ink: {ink}; --share: {share:.1%}"><b>{html.escape(task)}</b>'
        f'<span class="big">{success}</span> <span class="quiet">{words}</span></div>'
    )


def number_cards(row: Row | None) -> str:
    """The latest figures of learning."""
    cells = []
    for name, (label, meaning, decimals) in NUMBERS.items():
        value = row.get(name) if row else None
        text = "–" if not isinstance(value, int | float) else f"{value:,.{decimals}f}".replace("-", "−")
        cells.append(f'<div title="{meaning}"><dt>{label}</dt><dd>{text}</dd></div>')
    return f'<dl class="numbers">{"".join(cells)}</dl>'


def event_list(events: Sequence[Row]) -> str:
    """The run's events, the newest first."""
    rows = []
    for event in reversed(events):
        ink = EVENT_COLOURS.get(str(event.get("kind")), NEUTRAL)
        when, text = event.get("wall_s"), html.escape(str(event.get("text", "")))
        stamp = duration(when) if isinstance(when, int | float) else "–"
        rows.append(
            f'<div class="event"><time>{stamp}</time><span class="dot" style="--ink: {ink}"></span>'
            f'<span class="text">{text}</span></div>'
        )
    return f'<div class="events">{"".join(rows) or "No event yet."}</div>'
