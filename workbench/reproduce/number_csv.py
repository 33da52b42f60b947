"""The numbers of a result set as CSV, a line for each, with its run and the command that makes it again."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Final

from workbench.csv_cells import plain_row
from workbench.reproduce.result_set import ResultSet

COLUMNS: Final = (
    "variant", "task", "seed", "purpose", "success_rate", "success_low", "success_high", "mean_return", "mean_length_s",
    "episodes", "evaluation_seed", "epochs", "env_steps", "wall_s", "run", "policy", "policy_digest", "command",
)  # fmt: skip
CURVE_COLUMNS: Final = ("variant", "task", "seed", "env_steps", "success_rate", "mean_return")
FLIGHT_COLUMNS: Final = ("variant", "missile", "time_s", "azimuth_deg")


def csv_text(result: ResultSet) -> str:
    """Numbers; for Fig. 12, which has none, the azimuth curves."""
    if result.item == "fig12":
        rows = [
            (flight.variant, missile.number, time_s, angle)
            for flight in result.flights
            for missile in flight.missiles
            for time_s, angle in zip(flight.time_s, missile.azimuth_deg, strict=True)
            if angle is not None
        ]
        return _text(FLIGHT_COLUMNS, rows)
    rows = []
    for number in result.numbers:
        low, high = number.success_ci95
        values = {**vars(number), "success_low": low, "success_high": high}
        rows.append(tuple(values[name] for name in COLUMNS))
    return _text(COLUMNS, rows)


def curves_csv_text(result: ResultSet) -> str:
    """Learning curves of every seed."""
    rows = [
        (curve.variant, curve.task, curve.seed, *point)
        for curve in result.curves
        for point in zip(curve.env_steps, curve.success_rate, curve.mean_return, strict=True)
    ]
    return _text(CURVE_COLUMNS, rows)


def _text(columns: tuple[str, ...], rows: Sequence[Sequence[object]]) -> str:
    content = io.StringIO()
    writer = csv.writer(content, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(map(plain_row, rows))
    return content.getvalue()
