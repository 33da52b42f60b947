"""Tables and points of the scorecard as text, for the terminal and for Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from agents.statistics import Interval
from workbench.reproduce.result_set import Number


@dataclass(frozen=True)
class Table:
    """A titled table of strings."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        """The table in Markdown, its title above."""
        lines = [self.columns, ["---"] * len(self.columns), *self.rows]
        rows = [f"| {' | '.join(_escaped(cell) for cell in line)} |" for line in lines]
        return "\n".join([f"**{self.title}**", "", *rows])


def share_text(share: float | np.ndarray) -> str:
    """A share 0..1 as a percentage."""
    return f"{float(share):.1%}".replace("%", " %")


def points_text(interval: Interval) -> str:
    """A difference of shares in percentage points, signed, with its interval where there is one."""
    value, low, high = (100.0 * float(part) for part in interval)
    return f"{value:+.1f}" if np.isnan(low) else f"{value:+.1f} [{low:.1f}, {high:.1f}]"


def number_text(number: Number) -> str:
    """Return, success with its Wilson interval, and the seed if there is one."""
    seed = "" if number.seed is None else f" (seed {number.seed})"
    return f"{number.mean_return:.1f}, {success_text(number)}{seed}"


def success_text(number: Number) -> str:
    """Success with its Wilson interval."""
    low, high = number.success_ci95
    return f"{share_text(number.success_rate)} [{100 * low:.1f}, {100 * high:.1f}]"


def interval_text(interval: Interval, form: str) -> str:
    """A value and its bounds in brackets; without bounds where one seed is all there is."""
    value, low, high = (form.format(float(part)).replace("%", " %") for part in interval)
    return value if np.isnan(float(interval.low)) else f"{value} [{low.removesuffix(' %')}, {high.removesuffix(' %')}]"


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|").replace("\n", " ")
