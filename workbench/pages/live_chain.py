"""Every stage of a training as a card: its mask, its guide, how far it is, when it is passed and how near that is."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from agents.config import VARIANTS, TrainingConfig
from agents.hyperparameters import Hyperparameters
from layouts.theme import missile_colour
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.pages.curriculum_cards import title
from workbench.pages.live_promotion import never_promotes, passed, percent_short, rule_words
from workbench.run_state import RunState
from workbench.stages import end_of, promoted
from workbench.terminal import duration, percent

WORDS = {"now": "learning", "halted": "halted", "waiting": "waits"}
GUIDES = {"expert-navigation": "Navigation expert", "expert-dragging": "Dragging expert", "random": "random policy"}


class LiveChain(JSComponent):
    """The cards in the order in which the stages are trained."""

    cards = param.String(default="[]", doc="JSON: dicts as `chain_cards` makes them; every text is shown as text")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


@dataclass(frozen=True)
class Learned:
    """What is known of a training when its cards are drawn."""

    config: TrainingConfig
    state: RunState
    last: Mapping[str, Any] | None
    """Its latest metrics row."""
    stages: Sequence[Mapping[str, Any]]
    """What each begun stage has reached (`workbench.stages.summarise`)."""
    events: Sequence[Mapping[str, Any]]
    evaluated: tuple[float, float] | None = None
    """Success and mean length [s] of the latest held-out evaluation of the stage being learned."""


def chain_json(learned: Learned) -> str:
    """What `LiveChain` shows.

    Raises:
        ScenarioError: the scenario of the run is not there any more.
    """
    return json.dumps([_card(learned, number, task) for number, task in enumerate(stage_tasks(learned.config))])


def stage_tasks(config: TrainingConfig) -> list[Task]:
    """The tasks a training learns, in order.

    Raises:
        ScenarioError: the scenario of the run is not there any more.
    """
    target = Task(load_scenario(config.scenario))
    return [target.mask(missile for missile in target.missiles if missile not in kept) for kept in config.stages]


def _card(learned: Learned, number: int, task: Task) -> dict[str, Any]:
    config, state = learned.config, learned.state
    begun = learned.stages[number] if number < len(learned.stages) else None
    kind = _kind(state, number, len(learned.stages))
    end = end_of(learned.events, task.name) if kind == "done" else None
    kind, word = _verdict(end, config.hyperparameters) if kind == "done" else (kind, WORDS[kind])
    before = set(config.stages[number - 1]) if number else set()
    every = range(1, task.scenario.launch.missiles + 1)
    return {
        "kind": kind,
        "word": word,
        "place": f"stage {number + 1} of {len(config.stages)}" if len(config.stages) > 1 else "one stage",
        "title": title(task),
        "missiles": [
            {"number": each, "ink": missile_colour(each), "masked": each in task.masked,
             "new": number > 0 and each not in task.masked and each not in before}
            for each in every
        ],
        "guide": _guide(learned, number, task),
        "best": percent(None if begun is None else begun["success_rate"]),
        **_progress(learned, number, kind, begun),
        **_promotion(learned, kind, end, begun),
    }  # fmt: skip


def _kind(state: RunState, number: int, begun: int) -> str:
    """`done`, `now`, `halted` (begun, and nothing works on it) or `waiting`."""
    current = max(begun - 1, 0)
    if state.state == "finished" or number < current:
        return "done"
    if number > current or state.state == "queued":
        return "waiting"
    return "now" if state.state in ("running", "stalled") else "halted"


def _verdict(end: Mapping[str, Any] | None, hyper: Hyperparameters) -> tuple[str, str]:
    """Kind and word of a stage that has ended: `spent` if there was a rule to pass, and its epochs ran out before."""
    if end is None or never_promotes(hyper):
        return "done", "done"
    return ("done", "passed") if promoted(end) else ("spent", "not passed")


def _guide(learned: Learned, number: int, task: Task) -> str:
    if not VARIANTS[learned.config.variant].guided:
        return "no guide: it learns from scratch"
    if number:
        return f"guide: the policy of stage {number}"
    words = f"{task.name} guided by "
    told = [str(event.get("text", "")) for event in learned.events if event.get("kind") == "stage_started"]
    name = next((text.removeprefix(words) for text in told if text.startswith(words)), learned.config.guide)
    return f"guide: {GUIDES.get(name, name) or 'the next easier policy'}"


def _progress(learned: Learned, number: int, kind: str, begun: Mapping[str, Any] | None) -> dict[str, Any]:
    epochs = learned.config.hyperparameters.epochs
    if begun is None:
        if kind == "now":
            return {"share": 0.0, "epochs": "first epoch", "time": ""}
        epoch_s = _epoch_s(learned.stages)
        most = f"at most {duration(epochs * epoch_s)}" if epoch_s and learned.state.active else ""
        return {"share": 0.0, "epochs": f"≤ {epochs} epochs", "time": most}
    done, worked = begun["epochs"], begun["wall_s"]
    count = f"{done} epoch{'s' * (done != 1)}"
    if kind in ("done", "spent"):
        return {"share": 1.0, "epochs": count, "time": duration(worked)}
    left = (
        f"at most {duration(worked / max(done, 1) * max(epochs - done, 0))} left" if kind == "now" else duration(worked)
    )
    return {"share": min(done / epochs, 1.0), "epochs": f"epoch {done} of {epochs}",
            "time": left}  # fmt: skip


def _epoch_s(stages: Sequence[Mapping[str, Any]]) -> float:
    """How long the latest stage's epochs take [s]; 0 while nobody knows."""
    return stages[-1]["wall_s"] / max(stages[-1]["epochs"], 1) if stages else 0.0


def _promotion(
    learned: Learned, kind: str, end: Mapping[str, Any] | None, begun: Mapping[str, Any] | None
) -> dict[str, Any]:
    """The rule in words, its threshold, the present value, and how many evaluations are passed of how many."""
    hyper = learned.config.hyperparameters
    if end is not None:
        return {"rule": _ended(end), "threshold": None, "value": None, "now": "", "least": 0, "of": 0}
    facts = {"rule": rule_words(hyper), "threshold": None, "value": None, "now": "", "least": 0, "of": 0}
    if never_promotes(hyper):
        return facts
    facts |= {"threshold": hyper.promotion_success, "of": hyper.promotion_evaluations}
    if begun is None or learned.evaluated is None or kind not in ("now", "halted"):
        return facts
    rate, length_s = learned.evaluated
    found = passed(rate, length_s, hyper)
    now = f"now {percent_short(rate)}, {found.words(hyper.promotion_evaluations)}"
    return facts | {"value": rate, "now": now, "least": found.least}


def _ended(event: Mapping[str, Any]) -> str:
    """How a stage ended: `promoted`, or the reason, and what its policy is worth."""
    rate = event.get("success_rate")
    words = "promoted" if promoted(event) else f"ended: {event.get('reason', '')}"
    return f"{words}; {percent(rate)} of fresh episodes" if isinstance(rate, int | float) else words
