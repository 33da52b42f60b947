"""The figures of one policy on one task as every picture and table of a comparison takes them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from agents.evaluation import WILSON_Z, Evaluation
from sim.assets import asset_path
from sim.errors import SubMasError
from sim.task import Task
from sim.world import Outcome
from workbench.comparison.work import Work
from workbench.reproduce.result_file import load
from workbench.reproduce.result_set import Number, ResultSet

SHIPPED = ("results", "fast", "fig13.json")
"""The result set that comes with the workbench: Fig. 13 of the shipped policies."""
FAILURES = ("shot_down", "left_field", "timeout", "not_finite")


@dataclass(frozen=True)
class CellFigures:
    """How one policy fared on one task."""

    episodes: int
    success_rate: float
    success_ci95: tuple[float, float]
    """Wilson 95 % interval."""
    mean_return: float
    return_ci95: tuple[float, float] | None
    """Normal 95 % interval of the mean; None where the single engagements are not there."""
    mean_length_s: float
    causes: Mapping[str, int]
    """Engagements lost, by cause: `shot_down_1` … by the missile, `shot_down` where nobody noted it, and the rest of
    `FAILURES`; causes that never occurred are left out."""
    command: str
    """Command line that gives these figures."""
    shipped: bool = False
    """Read from the result set that comes with the workbench, not flown here."""


def flown_figures(evaluation: Evaluation, work: Work) -> CellFigures:
    """Figures of an evaluation that was flown here, with its single engagements."""
    results = evaluation.results
    assert results is not None, "a comparison keeps every engagement"
    returns = results.episode_return.astype(np.float64)
    half = WILSON_Z * float(returns.std(ddof=1)) / math.sqrt(len(returns)) if len(returns) > 1 else math.inf
    shot = results.killer[results.outcome == Outcome.SHOT_DOWN]
    causes = {f"shot_down_{number}": int((shot == number).sum()) for number in evaluation.missiles}
    causes |= {name: evaluation.outcomes.get(name, 0) for name in FAILURES if name != "shot_down"}
    interval = (evaluation.mean_return - half, evaluation.mean_return + half)
    return CellFigures(
        evaluation.episodes, evaluation.success_rate, evaluation.success_ci95, evaluation.mean_return,
        interval if math.isfinite(half) else None, evaluation.mean_length_s, _occurred(causes), command(work),
    )  # fmt: skip


def shipped_figures(work: Work, task: Task) -> CellFigures | None:
    """Figures of the result set that comes with the workbench, if it has those of exactly this work."""
    result = shipped_set()
    for number in result.numbers if result else ():
        if _is(number, work, task):
            return _figures_of(number)
    return None


@cache
def shipped_set() -> ResultSet | None:
    """The result set of Fig. 13 that comes with the workbench, if it is there and can be read."""
    try:
        return load(asset_path(*SHIPPED))
    except SubMasError:
        return None


def command(work: Work) -> str:
    """Command line that flies the same."""
    words = ["workbench evaluate", work.policy]
    if work.scenario != "default":
        words.append(f"--scenario {work.scenario}")
    if work.mask:
        words.append(f"--mask {work.mask}")
    return " ".join([*words, f"--episodes {work.episodes}", f"--seed {work.seed}"])


def _is(number: Number, work: Work, task: Task) -> bool:
    known = (number.policy, number.policy_digest, number.task, number.scenario_digest)
    flown = (number.episodes, number.evaluation_seed, number.purpose)
    return (
        known == (work.policy, work.policy_digest, task.name, work.scenario_digest)
        and flown == (work.episodes, work.seed, "report")
    )  # fmt: skip


def _figures_of(number: Number) -> CellFigures:
    causes = {name: number.outcomes.get(name, 0) for name in FAILURES}
    return CellFigures(
        number.episodes, number.success_rate, number.success_ci95, number.mean_return, None, number.mean_length_s,
        _occurred(causes), number.command, shipped=True,
    )  # fmt: skip


def _occurred(causes: Mapping[str, int]) -> dict[str, int]:
    return {name: count for name, count in causes.items() if count}
