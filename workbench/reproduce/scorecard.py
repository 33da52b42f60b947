"""The scorecard of one item: tables, points and notes, ours beside the paper's, from its result set alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from agents.statistics import bootstrap
from workbench.reproduce import table4
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.points import POINTS, finding
from workbench.reproduce.protocol import LABELS, TASK_LABELS, TRAINED_FOR, Item
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.text_table import Table, interval_text, number_text

TITLES = {
    "table4": "Table 4: all algorithms on the target task",
    "fig8": "Fig. 8: ablations while they learn",
    "fig9": "Fig. 9: SubMas-RL and learning from scratch",
    "fig12": "Fig. 12: azimuth of the missiles",
    "fig13": "Fig. 13: SubMas-RL and the expert on all tasks",
}
NOT_RUN = "not run yet"


@dataclass(frozen=True)
class Scorecard:
    """What there is to say about one item."""

    item: Item
    title: str
    tables: Sequence[Table]
    notes: Sequence[str]
    """Sentences: how many seeds, what failed, what is missing."""


def scorecard(item: Item, result: ResultSet | None) -> Scorecard:
    """The scorecard of an item; without a result set it says that nothing was run."""
    tables = [*_figures(item, result), _points(item, result)]
    return Scorecard(item, TITLES[item], tables, list(_notes(item, result)))


def seeds_there(result: ResultSet, variant: str) -> int:
    """Seeds of one algorithm that are trained."""
    return sum(training.variant == variant and training.state == "finished" for training in result.trainings)


def complete(result: ResultSet) -> bool:
    """Whether everything the paper's item asks for is there, for all seeds that were asked for."""
    if result.item == "fig12":
        return bool(result.flights)
    if result.item == "fig13":
        return all(result.reported(variant, task) for variant in ("submas", "expert") for task in CHAIN)
    return not result.left_out and all(
        len(result.reported(variant, "target")) == result.asked_for(variant) for variant in TRAINED_FOR[result.item]
    )


def _figures(item: Item, result: ResultSet | None) -> Iterator[Table]:
    if item == "table4":
        yield table4.table(result)
    elif result is not None and item == "fig13":
        yield _fig13(result)
    elif result is not None and item in ("fig8", "fig9"):
        yield _finals(result)


def _points(item: Item, result: ResultSet | None) -> Table:
    rows = []
    for point in POINTS[item]:
        verdict, words = finding(point, result) or ("–", NOT_RUN)
        rows.append((point.says, point.where, words, verdict))
    return Table("Point by point", ("the paper says", "where", "here", "holds here"), rows)


def _finals(result: ResultSet) -> Table:
    """Success after training by algorithm and task, and over all tasks together with tasks as strata."""
    tasks = CHAIN[1:] if result.item == "fig8" else CHAIN[-1:]
    rows = []
    for variant in TRAINED_FOR[result.item]:
        strata = [[number.success_rate for number in result.reported(variant, task)] for task in tasks]
        cells = [interval_text(bootstrap([runs]), "{:.1%}") if runs else NOT_RUN for runs in strata]
        if len(tasks) > 1:
            cells.append(interval_text(bootstrap(strata), "{:.1%}") if all(strata) else "–")
        rows.append((LABELS[variant], *cells, str(seeds_there(result, variant))))
    every = ("all four tasks",) if len(tasks) > 1 else ()
    columns = ("algorithm", *(TASK_LABELS[task] for task in tasks), *every, "seeds")
    return Table("Success of the trained policies, interquartile mean over seeds [95 % bootstrap]", columns, rows)


def _fig13(result: ResultSet) -> Table:
    names = ("submas", "expert", "submas-target")
    rows = []
    for task in CHAIN:
        found = [result.reported(variant, task) for variant in names]
        cells = [number_text(numbers[0]) if numbers else NOT_RUN for numbers in found]
        rows.append((TASK_LABELS[task], *cells))
    columns = ("task", "SubMas-RL, each task's own policy", "dragging expert", "SubMas-RL, the target's policy")
    return Table("Return and success [Wilson 95 %]", columns, rows)


def _notes(item: Item, result: ResultSet | None) -> Iterator[str]:
    if result is None:
        yield f"Not run yet: `workbench reproduce {item}` runs it."
        return
    yield f"Made by `{result.command}`: {_flown(result)}."
    variants = TRAINED_FOR[item]
    if variants:
        yield f"Seeds trained, of {_seeds_trained(result, variants)}."
        if 0 < max(seeds_there(result, variant) for variant in variants) < 10:
            yield "The paper has ten seeds; with fewer, bootstrap intervals are too narrow."
    if item == "fig9" and result.trainings:
        yield _steps(result)
    yield from (f"{sentence}." for sentence in result.left_out)
    for training in result.trainings:
        if training.error:
            yield f"Not trained: {training.error}."


def _seeds_trained(result: ResultSet, variants: Sequence[str]) -> str:
    there = {variant: seeds_there(result, variant) for variant in variants}
    if not result.seed_counts:
        counts = ", ".join(f"{LABELS[variant]} {count}" for variant, count in there.items())
        return f"{len(result.seeds)} asked for: {counts}"
    counts = ", ".join(f"{LABELS[v]} {count} of {result.asked_for(v)}" for v, count in there.items())
    return f"those asked for: {counts}"


def _steps(result: ResultSet) -> str:
    """What SubMas-RL has flown before the target task must be told beside learning from scratch."""
    steps = {v: [t.env_steps for t in result.trainings if t.variant == v and t.env_steps] for v in TRAINED_FOR["fig9"]}
    words = ", ".join(f"{LABELS[v]} {median(found) / 1e6:.2f}" for v, found in steps.items() if found)
    return f"Environment steps of a whole training, all its tasks together, median in millions: {words}."


def _flown(result: ResultSet) -> str:
    if result.item == "fig12":
        return "one engagement, the first reported episode in which both policies evade everything and arrive"
    return f"profile {result.profile}, {result.episodes} episodes behind every number"
