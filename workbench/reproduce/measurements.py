"""The numbers of a reproduction: known ones from earlier result sets, the others flown as soon as a policy is there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from statistics import median

from sim.assets import asset_path
from workbench.reproduce.assembly import Ended, Figures
from workbench.reproduce.eta import TYPICAL_EVALUATION_S
from workbench.reproduce.evaluations import Evaluation, Evaluator, FigureKey, figure_key
from workbench.reproduce.matching import Key, training_key
from workbench.reproduce.plan import Plan, Wanted, training_of
from workbench.reproduce.protocol import ITEMS, LABELS, TASK_LABELS
from workbench.reproduce.provenance import Provenance, file_digest, flies_the_same
from workbench.reproduce.result_file import ResultSetError, load
from workbench.terminal import percent

KEPT = ("success_rate", "success_ci95", "mean_return", "mean_length_s", "outcomes", "scenario_digest")


class Measurements:
    """Every evaluation that some plans ask for, each once."""

    def __init__(self, plans: Sequence[Plan], runs: Path, known: Mapping[FigureKey, Figures]) -> None:
        """`runs` is the folder of the runs; `known` figures are not flown again."""
        self.failures: dict[FigureKey, str] = {}
        self._plans, self._runs = plans, runs
        self._figures = dict(known)
        self._evaluator = Evaluator()
        self._times_s: list[float] = []

    def round(self, ended: Mapping[Key, Ended], at_once: int) -> list[str]:
        """Take what has been flown, begin what can be; a line about each evaluation that ended since the last round."""
        news = []
        for flown in self._evaluator.ended():
            evaluation = flown.evaluation
            if flown.figures is None:
                self.failures[evaluation.key] = flown.error
                news.append(flown.error)
            else:
                self._figures[evaluation.key] = {name: flown.figures[name] for name in KEPT}
                self._times_s.append(flown.wall_s)
                news.append(f"{described(evaluation.wanted)}: success {percent(flown.figures['success_rate'])}")
        for evaluation in self.due(ended)[: max(at_once - len(self._evaluator.keys), 0)]:
            self._evaluator.start(evaluation)
        return news

    @property
    def typical_s(self) -> float:
        """Time one evaluation takes here [s]."""
        return median(self._times_s) if self._times_s else TYPICAL_EVALUATION_S

    @property
    def flying(self) -> int:
        """Evaluations that are under way."""
        return len(self._evaluator.keys)

    def due(self, ended: Mapping[Key, Ended]) -> list[Evaluation]:
        """What can be flown, is not known, has not failed and is not being flown."""
        known = self._figures.keys() | self.failures.keys() | self._evaluator.keys
        every = [evaluation for plan in self._plans for evaluation in self._possible(plan, ended)]
        return list({evaluation.key: evaluation for evaluation in every if evaluation.key not in known}.values())

    def known(self, plan: Plan, ended: Mapping[Key, Ended]) -> Iterator[tuple[Evaluation, Figures]]:
        """The evaluations of one plan whose figures are there."""
        for evaluation in self._possible(plan, ended):
            if evaluation.key in self._figures:
                yield evaluation, self._figures[evaluation.key]

    def stop(self) -> None:
        """End what is being flown."""
        self._evaluator.stop()

    def _possible(self, plan: Plan, ended: Mapping[Key, Ended]) -> Iterator[Evaluation]:
        for wanted in plan.wanted:
            if wanted.seed is None:
                yield Evaluation(wanted, wanted.policy, wanted.policy, shipped_digest(wanted.policy), plan.episodes)
                continue
            training = ended.get(training_key(training_of(wanted.variant, plan.profile, wanted.seed)))
            if training is not None and wanted.task in training.policies:
                file = f"{training.run}/policies/{wanted.task}.safetensors"
                digest = training.policies[wanted.task]
                yield Evaluation(wanted, str(self._runs / file), f"runs/{file}", digest, plan.episodes)


def known_figures(folder: Path, origin: Provenance) -> dict[FigureKey, Figures]:
    """Figures in the result sets of a folder that this source and this scenario would give again."""
    figures = {}
    for item in ITEMS:
        try:
            result = load(folder / f"{item}.json")
        except ResultSetError:
            continue  # what cannot be read is flown again and replaced
        if result is None or not flies_the_same(result.source_digest, origin.source_digest):
            continue
        for number in result.numbers:
            if number.scenario_digest == origin.scenario_digest:
                wanted = Wanted(number.variant, number.task, number.purpose)
                key = figure_key(number.policy_digest or number.policy, wanted, number.episodes)
                figures[key] = {name: getattr(number, name) for name in KEPT}
    return figures


def described(wanted: Wanted) -> str:
    """An evaluation in a few words."""
    seed = "" if wanted.seed is None else f" seed {wanted.seed}"
    other = "" if wanted.purpose == "report" else " (other episodes)"
    return f"{LABELS[wanted.variant]}{seed}, {TASK_LABELS[wanted.task]}{other}"


@cache
def shipped_digest(policy: str) -> str:
    """Digest of a policy that comes with the workbench; empty for a rule."""
    path = asset_path("policies", f"{policy}.safetensors")
    return file_digest(path) if path.is_file() else ""
