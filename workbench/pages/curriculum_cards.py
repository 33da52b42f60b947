"""What masking does to the task, as HTML: observation (Table 1), reward terms (Eq. 9-11), Xi and Psi (Eq. 5-6)."""

from __future__ import annotations

from collections.abc import Iterable

from layouts.theme import NEUTRAL, missile_colour
from sim.observation import UNLAUNCHED
from sim.task import Task

CARD_CSS = """
.card { font: 14px/1.45 var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color) }
h2 { font-size: 15px; font-weight: 650; margin: 0 0 8px }
h2 small { font-weight: 400; opacity: .65; font-size: 12.5px; margin-left: 8px }
p { margin: 8px 0 0; opacity: .82; font-size: 13px }
p b { font-weight: 650 }
.chips { display: flex; flex-wrap: wrap; gap: 6px }
.chip { border-radius: 8px; padding: 4px 8px;
  border: 1.5px solid color-mix(in srgb, var(--ink) 70%, transparent);
  background: color-mix(in srgb, var(--ink) 15%, transparent);
  font-weight: 600; white-space: nowrap; text-align: center;
  min-width: 30px }
.chip small { display: block; font-weight: 400; font-size: 11px; opacity: .8 }
.gone { background: none; border-style: dashed; font-weight: 400; opacity: .72 }
.gone b, .gone i, .gone sup, .gone sub { text-decoration: line-through }
.op { align-self: center; opacity: .6; margin: 0 -3px }
sub, sup { font-size: .72em; line-height: 0; margin-left: 1px }
.name { font-size: 21px; font-weight: 700; line-height: 1.2 }
.sub { opacity: .78; font-size: 13.5px }
code { font: 13px ui-monospace, monospace; background: color-mix(in srgb, currentColor 10%, transparent);
  padding: 1px 6px; border-radius: 5px }
"""

SYMBOLS = {
    "x": ("<i>x</i>", "position"),
    "y": ("<i>y</i>", "position"),
    "psi": ("<i>ψ</i>", "yaw"),
    "l": ("<i>l</i>", "range"),
    "theta_AA": ("<i>θ</i><sub>AA</sub>", "aspect"),
    "theta_ATA": ("<i>θ</i><sub>ATA</sub>", "antenna train"),
    "phi_exit": ("<i>φ</i><sub>Exit</sub>", "azimuth of exit"),
}
"""Columns every task has (Table 1): how the paper writes them, and what they are."""


def task_card(task: Task) -> str:
    """Name of the task, what is left to do, and how to name it on the command line."""
    left = _numbers(task.missiles)
    todo = f"evade missile{'s' * (len(task.missiles) > 1)} {left}, reach the exit" if left else "reach the exit"
    mask = ",".join(map(str, sorted(task.masked)))
    option = f"<code>--mask {mask}</code>" if mask else "no mask"
    return f'<div class="card"><div class="name">{title(task)}</div><div class="sub">{todo} · {option}</div></div>'


def title(task: Task) -> str:
    """The task's name as the paper writes it."""
    if task.name == "target":
        return "Target task"
    if task.name.startswith("source-"):
        return f"Source task {task.name.removeprefix('source-')}"
    return f"Missiles {_numbers(task.missiles)}" if len(task.missiles) > 1 else f"Missile {_numbers(task.missiles)}"


def observation_card(task: Task) -> str:
    """The target's observation column by column: kept by Xi, or masked (Psi)."""
    target = Task(task.scenario)
    kept = set(task.layout.names)
    chips = "".join(_column(name, name in kept) for name in target.layout.names)
    return (
        '<div class="card"><h2>Observation '
        f"<small>Table 1 · {task.layout.size} of {target.layout.size} numbers</small></h2>"
        f'<div class="chips">{chips}</div>{_maps(task)}</div>'
    )


def reward_card(task: Task) -> str:
    """The reward as a sum of terms; those of masked missiles are removed."""
    reward = task.scenario.reward
    lost = _signed(reward.shot_down)
    goal = f"{_signed(reward.exit)} exit, {lost} outside"
    terms = [_chip("<i>R</i><sup>goal</sup>", goal, NEUTRAL, kept=True)]
    for missile in range(1, task.scenario.launch.missiles + 1):
        words = f"{_signed(reward.evaded)} or {lost}"
        kept = missile not in task.masked
        terms.append(_chip(f"<i>R</i><sup>τ{missile}</sup>", words, missile_colour(missile), kept))
    terms.append(_chip("<i>R</i><sup>time</sup>", f"{_signed(reward.step)} a step", NEUTRAL, kept=True))
    chips = '<span class="op">+</span>'.join(terms)
    return (
        '<div class="card"><h2>Reward <small>Eq. 9: goal + subtasks (evaded or shot down) + time</small></h2>'
        f'<div class="chips">{chips}</div><p>{_removed(task)}</p></div>'
    )


def _removed(task: Task) -> str:
    if not task.masked:
        return "The target task keeps every term."
    many = "s" * (len(task.masked) > 1)
    return (
        f"Removed with the mask (Eq. 10–11): the term{many} of missile{many} {_numbers(task.masked)}. "
        "While none of them flies, the reward is the target's (Eq. 12)."
    )


def _signed(number: float) -> str:
    return f"{number:+g}".replace("-", "−")


def _maps(task: Task) -> str:
    target = Task(task.scenario)
    dropped = [target.layout.names[column] for column in target.layout.masked_columns(task.layout)]
    if not dropped:
        return (
            "<p><b>Ξ</b> keeps every number and <b>Ψ</b> masks none: this is the target task itself. Mask a missile "
            "to see what is left.</p>"
        )
    names = ", ".join(_symbol(name) for name in dropped)
    default = f"[{_default(UNLAUNCHED[0])}, {_default(UNLAUNCHED[1])}]"
    return (
        f"<p><b>Ξ</b> (Eq. 5–6) keeps {task.layout.size} numbers of a state of the target, <b>Ψ</b> the masked "
        f"{len(dropped)}: {names}. A policy of this task may guide the target only while Ψ shows the default "
        f"{default} for each masked missile: not yet launched, or evaded (Eq. 13).</p>"
    )


def _default(number: float) -> str:
    """A number of the default vector as the paper writes it."""
    return "−π" if number < -3.0 else f"{number:g}".replace("-", "−")


def _column(name: str, kept: bool) -> str:
    if name in SYMBOLS:
        symbol, words = SYMBOLS[name]
        return _chip(symbol, words, NEUTRAL, kept)
    kind, missile = name.split("_")
    default = dict(zip(["r", "phi"], UNLAUNCHED, strict=True))[kind]
    words = ("range" if kind == "r" else "azimuth") if kept else f"= {_default(default)}"
    return _chip(_symbol(name), words, missile_colour(int(missile)), kept)


def _symbol(name: str) -> str:
    kind, missile = name.split("_")
    return f"<i>{'r' if kind == 'r' else 'φ'}</i><sub>{missile}</sub>"


def _chip(symbol: str, words: str, colour: str, kept: bool) -> str:
    return f'<span class="chip{"" if kept else " gone"}" style="--ink: {colour}">{symbol}<small>{words}</small></span>'


def _numbers(missiles: Iterable[int]) -> str:
    return ", ".join(map(str, sorted(missiles)))
