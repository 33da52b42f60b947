"""What earlier result sets hold, kept when trainings of another day or another machine are added to them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path

from agents.config import TrainingConfig
from sim.errors import UsageError
from workbench.reproduce.assembly import CURVED
from workbench.reproduce.matching import Key, training_key
from workbench.reproduce.plan import CHAIN, Plan, Wanted
from workbench.reproduce.provenance import Provenance, flies_the_same
from workbench.reproduce.result_file import load
from workbench.reproduce.result_set import Curve, Number, ResultSet, Training
from workbench.reproduce.stage_curves import evenly, points_per_curve


@dataclasses.dataclass(frozen=True)
class Earlier:
    """Trainings that need not be looked for: the result set of every plan that asks for them has them whole."""

    results: Mapping[str, ResultSet] = dataclasses.field(default_factory=dict)
    """By item."""
    keys: frozenset[Key] = frozenset()

    def added_to(self, plan: Plan, result: ResultSet) -> ResultSet:
        """The result set with the rows of kept trainings among its own, in the plan's order."""
        asked = [(config.variant, config.seed) for config in plan.trainings]
        kept = {who for who, config in zip(asked, plan.trainings, strict=True) if training_key(config) in self.keys}
        if not kept:
            return result
        before = self.results[plan.item]
        trainings = [*(row for row in before.trainings if _who(row) in kept), *result.trainings]
        numbers = [*(row for row in before.numbers if _who(row) in kept), *result.numbers]
        curves = [*(row for row in before.curves if _who(row) in kept), *result.curves]
        trainings.sort(key=lambda row: asked.index((row.variant, row.seed)))
        numbers.sort(key=lambda row: (asked.index((row.variant, row.seed or 0)), CHAIN.index(row.task), row.purpose))
        curves.sort(key=lambda row: (asked.index((row.variant, row.seed)), CHAIN.index(row.task)))
        return dataclasses.replace(
            result, trainings=tuple(trainings), numbers=tuple(numbers), curves=tuple(_thinned(curves))
        )


NOTHING_EARLIER = Earlier()


def earlier(plans: Sequence[Plan], folder: Path, origin: Provenance) -> Earlier:
    """What the result sets of a folder hold of these plans.

    Raises:
        ResultSetError: a result set is damaged.
        UsageError: one comes from another simulator or scenario, or other numbers of episodes: it cannot be added to.
    """
    results = {plan.item: found for plan in plans if plan.trainings and (found := load(folder / f"{plan.item}.json"))}
    for plan in plans:
        if plan.item in results:
            _refuse_others(plan, results[plan.item], origin, folder)
    configs = {training_key(config): config for plan in plans for config in plan.trainings}
    return Earlier(results, frozenset(key for key, config in configs.items() if _everywhere(config, plans, results)))


def _refuse_others(plan: Plan, found: ResultSet, origin: Provenance, folder: Path) -> None:
    theirs_and_ours = {
        "source": (found.source_digest, origin.source_digest),
        "scenario": (found.scenario_digest, origin.scenario_digest),
        "profile": (found.profile, plan.profile),
        "number of episodes": (found.episodes, plan.episodes),
    }
    for what, (theirs, ours) in theirs_and_ours.items():
        same = flies_the_same(str(theirs), str(ours)) if what == "source" else theirs == ours
        if not same:
            raise UsageError(
                f"{folder / f'{plan.item}.json'} cannot be added to: its {what} is {theirs}, this one's {ours}; "
                "without --add it is made anew"
            )


def _everywhere(config: TrainingConfig, plans: Sequence[Plan], results: Mapping[str, ResultSet]) -> bool:
    asking = [plan for plan in plans if config in plan.trainings]
    return all(plan.item in results and _whole(config, plan, results[plan.item]) for plan in asking)


def _whole(config: TrainingConfig, plan: Plan, found: ResultSet) -> bool:
    """Whether the result set has the finished training with every number and curve that the plan wants of it."""
    who = (config.variant, config.seed)
    finished = any(_who(row) == who and row.state == "finished" for row in found.trainings)
    wanted = {(one.task, one.purpose) for one in plan.wanted if _who(one) == who}
    numbers = {(row.task, row.purpose) for row in found.numbers if _who(row) == who}
    curves = {row.task for row in found.curves if _who(row) == who}
    return finished and wanted <= numbers and (plan.item not in CURVED or {task for task, _ in wanted} <= curves)


def _who(row: Training | Number | Curve | Wanted) -> tuple[str, int | None]:
    return row.variant, row.seed


def _thinned(curves: Sequence[Curve]) -> list[Curve]:
    """The same curves with few enough points for one file."""
    points = points_per_curve([len(curve.env_steps) for curve in curves])
    return [_thin(curve, points) for curve in curves]


def _thin(curve: Curve, points: int) -> Curve:
    rows = evenly(len(curve.env_steps), points)
    return dataclasses.replace(
        curve,
        env_steps=tuple(curve.env_steps[row] for row in rows),
        success_rate=tuple(curve.success_rate[row] for row in rows),
        mean_return=tuple(curve.mean_return[row] for row in rows),
    )
