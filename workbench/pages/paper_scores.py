"""The scorecards of `workbench.reproduce` as blocks of a sheet: their words, and which records are behind each cell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from layouts.theme import FAILURE, NEUTRAL, SUCCESS
from workbench.pages.paper_sheet import Block, Part, heading, notes, part, table
from workbench.pages.paper_sources import number_key, training_name
from workbench.reproduce import table4
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.points import POINTS, finding
from workbench.reproduce.protocol import LABELS, TRAINED_FOR, Item
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.scorecard import NOT_RUN, scorecard
from workbench.reproduce.text_table import Table

Keys = Sequence[str]
Behind = Mapping[tuple[int, int], Keys]
"""Keys of the records behind a cell, by row and column."""
STATE_INKS = {"finished": SUCCESS, "failed": FAILURE, "interrupted": FAILURE}


def points_of(item: Item, result: ResultSet | None) -> list[dict[str, str]]:
    """What the paper says, point by point, and what comes out here; an empty verdict where nothing was run."""
    found = []
    for point in POINTS[item]:
        verdict, here = finding(point, result) or ("", NOT_RUN)
        found.append({"says": point.says, "where": point.where, "here": here, "verdict": verdict})
    return found


def points_block(item: Item, result: ResultSet | None) -> Block:
    """The points as a block."""
    return {"kind": "points", "points": points_of(item, result)}


def score_blocks(item: Item, result: ResultSet | None) -> list[Block]:
    """Tables of figures and trainings of an item; every number knows the records behind it."""
    blocks: list[Block] = []
    # The last table of a scorecard is that of the points, which have a place of their own.
    for figures in scorecard(item, result).tables[:-1]:
        blocks += [heading(figures.title, "click a number to see where it comes from" if result else "")]
        blocks.append(_with_records(figures, dict(_behind(item, result)) if result else {}))
    if result is not None and TRAINED_FOR[item]:
        blocks += [heading("Trainings", "one chip for every seed"), _trainings(item, result)]
    return blocks


def notes_block(item: Item, result: ResultSet | None) -> Block:
    """What else there is to say."""
    return notes([note.replace("`", "") for note in scorecard(item, result).notes])


def _with_records(figures: Table, behind: Behind) -> Block:
    rows = [
        [[_cell(text, behind.get((row, column), ()))] for column, text in enumerate(cells)]
        for row, cells in enumerate(figures.rows)
    ]
    return table(figures.columns, rows)


def _cell(text: str, keys: Keys) -> Part:
    return part(text, refs=list(keys), tone="mute" if text in (NOT_RUN, "–") else "")


def _behind(item: Item, result: ResultSet) -> Iterator[tuple[tuple[int, int], Keys]]:
    if item == "table4":
        yield from _behind_table4(result)
    elif item == "fig13":
        for row, task in enumerate(CHAIN):
            for column, variant in enumerate(("submas", "expert", "submas-target"), start=1):
                yield (row, column), [number_key(number) for number in result.reported(variant, task)]
    else:
        tasks = CHAIN[1:] if item == "fig8" else CHAIN[-1:]
        for row, variant in enumerate(TRAINED_FOR[item]):
            for column, task in enumerate(tasks, start=1):
                yield (row, column), [number_key(number) for number in result.reported(variant, task)]


def _behind_table4(result: ResultSet) -> Iterator[tuple[tuple[int, int], Keys]]:
    places = {variant: row for row, variant in enumerate(table4.TABLE_4)}
    for row in table4.rows(result):
        every = [number_key(number) for number in row.numbers]
        place = places[row.variant]
        yield (place, 2), [number_key(row.best)]
        if row.chosen is not None:
            other = result.number(row.variant, "target", row.chosen.seed, "selection")
            yield (place, 3), [number_key(row.chosen), *([number_key(other)] if other else [])]
        yield (place, 4), every
        yield (place, 5), every


def _trainings(item: Item, result: ResultSet) -> Block:
    rows = []
    for variant in TRAINED_FOR[item]:
        there = {training.seed: training for training in result.trainings if training.variant == variant}
        chips = []
        for seed in sorted({*range(result.asked_for(variant)), *there}):
            training = there.get(seed)
            if training is None:
                chips.append(part(str(seed), ink=NEUTRAL, tone="waiting", title=f"seed {seed} is not trained yet"))
                continue
            ink = STATE_INKS.get(training.state, NEUTRAL)
            chips.append(
                part(str(seed), ink=ink, refs=[training_name(training)], title=f"seed {seed}: {training.state}")
            )
        rows.append([[part(LABELS[variant])], chips])
    return table(["algorithm", "seeds"], rows)
