"""Table 4: all algorithms on the target task, the best of several seeds and what lies behind it.

Taking the seed that did best on the very episodes that are reported flatters: part of its lead is luck on those
episodes. So the table says three things: the best of all seeds, as in the paper; the seed that was best on *other*
episodes, reported on these; and all seeds together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from agents.statistics import Interval, bootstrap
from workbench.reproduce.paper_numbers import TABLE_4
from workbench.reproduce.protocol import LABELS
from workbench.reproduce.result_set import Number, ResultSet
from workbench.reproduce.text_table import Table, interval_text, number_text, share_text


@dataclass(frozen=True)
class Row:
    """One algorithm of Table 4 over the seeds that are there."""

    variant: str
    numbers: Sequence[Number]
    """Reported number of every seed."""
    best: Number
    """Of the highest mean return among those, as in the paper (§4.3)."""
    chosen: Number | None
    """Reported number of the seed with the highest mean return on the selection episodes; None if those are missing."""
    returns: Interval
    success: Interval
    """Interquartile mean over the seeds, with its bootstrap interval."""


def rows(result: ResultSet) -> list[Row]:
    """Rows of the algorithms that have at least one seed, in the paper's order."""
    found = []
    for variant in TABLE_4:
        numbers = result.reported(variant, "target")
        if numbers:
            returns, success = ([getattr(n, name) for n in numbers] for name in ("mean_return", "success_rate"))
            best = max(numbers, key=lambda number: number.mean_return)
            chosen = chosen_elsewhere(result, variant)
            found.append(Row(variant, numbers, best, chosen, bootstrap([returns]), bootstrap([success])))
    return found


def chosen_elsewhere(result: ResultSet, variant: str) -> Number | None:
    """The reported number of the seed that was best on the selection episodes, which are no part of the report."""
    flown = [n for n in result.numbers if (n.variant, n.task, n.purpose) == (variant, "target", "selection")]
    if {n.seed for n in flown} != {n.seed for n in result.reported(variant, "target")} or not flown:
        return None
    return result.number(variant, "target", max(flown, key=lambda number: number.mean_return).seed)


def table(result: ResultSet | None) -> Table:
    """Table 4, ours beside the paper's; algorithms without a number say so."""
    by_variant = {row.variant: row for row in rows(result)} if result else {}
    lines = []
    for variant, (paper_return, paper_success) in TABLE_4.items():
        paper = f"{paper_return:.1f}, {share_text(paper_success)}"
        row = by_variant.get(variant)
        cells = _cells(row) if row else ("not run yet", "–", "–", "–", "0")
        lines.append((LABELS[variant], paper, *cells))
    columns = (
        "algorithm",
        "paper, best of 10 seeds",
        "best of our seeds, as in the paper",
        "best seed by other episodes",
        "all seeds: return",
        "all seeds: success",
        "seeds",
    )
    return Table("Return and success on the target task", columns, tuple(lines))


def _cells(row: Row) -> tuple[str, ...]:
    chosen = number_text(row.chosen) if row.chosen else "–"
    returns, success = interval_text(row.returns, "{:.1f}"), interval_text(row.success, "{:.1%}")
    return number_text(row.best), chosen, returns, success, str(len(row.numbers))
