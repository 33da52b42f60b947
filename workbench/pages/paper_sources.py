"""Where the numbers of the Paper page come from: a record for every number and training, with links and commands."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from workbench.pages.address import search
from workbench.reproduce.protocol import LABELS, TASK_LABELS
from workbench.reproduce.result_set import Flight, Number, ResultSet, Training
from workbench.reproduce.text_table import success_text
from workbench.terminal import duration

Record = dict[str, Any]
"""`title`, `facts` (name and text), `links` (label and address) and `commands` (label and command line)."""


def number_key(number: Number) -> str:
    """Name of a number in the address."""
    seed = "shipped" if number.seed is None else number.seed
    return f"{number.variant}.{number.task}.{seed}.{number.purpose}"


def training_name(training: Training) -> str:
    """Name of a training in the address."""
    return f"run.{training.variant}.{training.seed}"


def records(result: ResultSet, runs: Collection[str]) -> dict[str, Record]:
    """Records of everything in a result set by key; `runs` are those of this runs folder."""
    trainings = {training_name(training): training for training in result.trainings}
    found = {key: _of_training(training, result, runs) for key, training in trainings.items()}
    for number in result.numbers:
        training = trainings.get(f"run.{number.variant}.{number.seed}")
        found[number_key(number)] = _of_number(number, training, result, runs)
    for flight in result.flights:
        found[f"flight.{flight.variant}"] = _of_flight(flight, result)
    return found


def _of_number(number: Number, training: Training | None, result: ResultSet, runs: Collection[str]) -> Record:
    seed = "" if number.seed is None else f", seed {number.seed}"
    other = "" if number.purpose == "report" else ", on the episodes that only choose"
    outcomes = ", ".join(f"{name.replace('_', ' ')} {count}" for name, count in number.outcomes.items())
    facts = [
        ("success [Wilson 95 %]", success_text(number)),
        ("return", f"{number.mean_return:.2f}"),
        ("mean length", f"{number.mean_length_s:.0f} s"),
        ("outcomes", outcomes),
        ("episodes", f"{number.episodes}, seed {_power(number.evaluation_seed)}"),
        *_trained(number),
        *_origin(number.policy_digest, number.scenario_digest, result),
    ]
    commands = [("fly it", number.command)]
    commands += [("train it", training.command)] if training else []
    return {
        "title": f"{LABELS[number.variant]}, {TASK_LABELS[number.task]}{seed}{other}",
        "facts": [list(fact) for fact in facts if fact[1]],
        "links": _links(number.run, runs) if number.run else [["Fly it", _fly(number)]],
        "commands": [list(one) for one in (*commands, ("whole item", result.command))],
    }


def _of_training(training: Training, result: ResultSet, runs: Collection[str]) -> Record:
    facts = [
        ("state", training.state),
        ("why", training.error),
        ("run", _run(training.run, runs)),
        ("resumed", f"{training.resumes} times" if training.resumes else ""),
        ("time by the clock", duration(training.wall_s)),
        ("processor time", duration(training.cpu_s)),
        ("environment steps", f"{training.env_steps / 1e6:.2f} million"),
        ("profile", result.profile),
    ]
    return {
        "title": f"{LABELS[training.variant]}, seed {training.seed}",
        "facts": [list(fact) for fact in facts if fact[1]],
        "links": _links(training.run, runs),
        "commands": [["train it", training.command], ["whole item", result.command]],
    }


def _of_flight(flight: Flight, result: ResultSet) -> Record:
    facts = [
        ("policy", flight.policy),
        ("initial state", f"seed {_power(flight.seed)}, episode {flight.episode}"),
        ("outcome", flight.outcome),
        ("duration", f"{flight.duration_s:.0f} s"),
        *_origin(flight.policy_digest, flight.scenario_digest, result),
    ]
    return {
        "title": f"{LABELS[flight.variant]}, one engagement",
        "facts": [list(fact) for fact in facts if fact[1]],
        "links": [],
        "commands": [["whole item", flight.command]],
    }


def _trained(number: Number) -> list[tuple[str, str]]:
    if number.epochs is None:
        return [("policy", number.policy)]
    steps = f", {number.env_steps / 1e6:.2f} million steps" if number.env_steps else ""
    wall = f", {duration(number.wall_s)}" if number.wall_s else ""
    return [("run", number.run), ("this task's training", f"{number.epochs} epochs{steps}{wall}")]


def _origin(policy: str, scenario: str, result: ResultSet) -> list[tuple[str, str]]:
    return [
        ("policy file", policy),
        ("scenario", f"{result.scenario} ({scenario})"),
        ("version", f"{result.code_version}, source {result.source_digest}"),
    ]


def _run(run: str, runs: Collection[str]) -> str:
    return run if run in runs else f"{run}, not in this runs folder"


def _links(run: str, runs: Collection[str]) -> list[list[str]]:
    if run not in runs:
        return []
    return [
        ["Open in Live", "/live" + search({"run": run})],
        ["Find in Runs", "/runs" + search({"run": run})],
        ["Fly its best policy", "/fly" + search({"a": run})],
    ]


def _fly(number: Number) -> str:
    from workbench.reproduce.plan import Wanted

    mask = Wanted(number.variant, number.task, number.purpose).mask
    return "/fly" + search({"a": number.policy, "b": "expert-dragging", "mask": ",".join(map(str, mask))})


def _power(seed: int) -> str:
    """Seeds of reproductions are powers of two."""
    exponent = seed.bit_length() - 1
    return f"2^{exponent}" if seed > 1_000_000 and seed == 2**exponent else str(seed)
