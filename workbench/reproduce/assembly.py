"""Puts a result set together from finished trainings and known figures; nothing is computed but rounding."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from agents.card import command_of
from workbench.reproduce.evaluations import Evaluation
from workbench.reproduce.matching import Key, training_key
from workbench.reproduce.plan import Plan, training_of
from workbench.reproduce.protocol import SCENARIO
from workbench.reproduce.provenance import Provenance
from workbench.reproduce.result_set import Curve, Flight, Number, Replay, ResultSet, Training
from workbench.reproduce.stage_curves import StageRecord, points_per_curve, thinned

Figures = Mapping[str, Any]
"""What `workbench evaluate --json` prints."""
CURVED = ("fig8", "fig9")
"""Items that show how learning went."""


@dataclass(frozen=True)
class Ended:
    """A training that has ended, well or not."""

    variant: str
    seed: int
    state: str
    run: str
    wall_s: float = 0.0
    resumes: int = 0
    error: str = ""
    stages: Mapping[str, StageRecord] = field(default_factory=dict)
    """By the name of the task."""
    policies: Mapping[str, str] = field(default_factory=dict)
    """Digests of the stages' policy files, by the name of the task."""


@dataclass(frozen=True)
class Flown:
    """Single engagements that are shown."""

    flights: Sequence[Flight] = ()
    """Fig. 12."""
    replays: Sequence[Replay] = ()
    """Fig. 10 and 11."""


NOTHING_FLOWN = Flown()


def assemble(
    plan: Plan,
    origin: Provenance,
    ended: Mapping[Key, Ended],
    measured: Iterable[tuple[Evaluation, Figures]],
    flown: Flown = NOTHING_FLOWN,
) -> ResultSet:
    """The result set of an item as far as it has come.

    Args:
        plan: what the item needs.
        origin: digests and version that all numbers share.
        ended: trainings that have ended.
        measured: the plan's evaluations whose figures are known, in the plan's order.
        flown: engagements of Fig. 10 to 12.
    """
    mine = [ended[key] for config in plan.trainings if (key := training_key(config)) in ended]
    return ResultSet(
        item=plan.item,
        profile=plan.profile,
        scenario=SCENARIO,
        scenario_digest=origin.scenario_digest,
        episodes=plan.episodes,
        seeds=tuple(sorted({config.seed for config in plan.trainings})),
        seed_counts=_seed_counts(plan),
        command=plan.command,
        code_version=origin.code_version,
        source_digest=origin.source_digest,
        left_out=plan.left_out,
        trainings=tuple(_training(plan, one) for one in mine),
        numbers=tuple(_number(plan, ended, *pair) for pair in measured),
        curves=tuple(_curves(plan, mine)) if plan.item in CURVED else (),
        flights=tuple(flown.flights),
        replays=tuple(flown.replays),
    )


def _seed_counts(plan: Plan) -> dict[str, int]:
    """Trainings by algorithm, where they are not all asked for with the same number of seeds."""
    counts = Counter(str(config.variant) for config in plan.trainings)
    return dict(counts) if len(set(counts.values())) > 1 else {}


def _training(plan: Plan, one: Ended) -> Training:
    command = command_of(training_of(one.variant, plan.profile, one.seed))
    return Training(
        variant=one.variant,
        seed=one.seed,
        state=one.state,
        run=one.run,
        wall_s=round(one.wall_s, 1),
        cpu_s=round(sum(stage.cpu_s for stage in one.stages.values()), 1),
        env_steps=sum(stage.env_steps for stage in one.stages.values()),
        command=command,
        error=one.error,
        resumes=one.resumes,
    )


def _number(plan: Plan, ended: Mapping[Key, Ended], evaluation: Evaluation, figures: Figures) -> Number:
    wanted, stage, run = evaluation.wanted, None, ""
    if wanted.seed is not None:
        training = ended[training_key(training_of(wanted.variant, plan.profile, wanted.seed))]
        stage, run = training.stages.get(wanted.task), training.run
    low, high = figures["success_ci95"]
    return Number(
        variant=wanted.variant,
        task=wanted.task,
        seed=wanted.seed,
        purpose=wanted.purpose,
        success_rate=figures["success_rate"],
        success_ci95=(round(low, 4), round(high, 4)),
        mean_return=round(figures["mean_return"], 2),
        mean_length_s=round(figures["mean_length_s"], 1),
        outcomes={name: count for name, count in figures["outcomes"].items() if count},
        episodes=plan.episodes,
        evaluation_seed=wanted.evaluation_seed,
        epochs=stage.epochs if stage else None,
        env_steps=stage.env_steps if stage else None,
        wall_s=stage.wall_s if stage else None,
        run=run,
        policy=wanted.policy,
        policy_digest=evaluation.digest,
        scenario_digest=figures["scenario_digest"],
        command=evaluation.command,
    )


def _curves(plan: Plan, trainings: Sequence[Ended]) -> Iterator[Curve]:
    tasks = {(wanted.variant, wanted.task): None for wanted in plan.wanted}
    shown = [
        (one, task)
        for one in trainings
        for variant, task in tasks
        if one.state == "finished" and variant == one.variant and task in one.stages
    ]
    points = points_per_curve([len(one.stages[task].steps) for one, task in shown])
    for one, task in shown:
        stage = thinned(one.stages[task], points)
        yield Curve(
            variant=one.variant,
            task=task,
            seed=one.seed,
            env_steps=stage.steps,
            success_rate=stage.success_rate,
            mean_return=stage.mean_return,
        )
