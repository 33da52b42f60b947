"""Tables of a comparison as CSV: a row per policy and task, per pair, or per engagement."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from agents.evaluation import Evaluation
from sim.world import Outcome
from workbench.comparison.figures import FAILURES
from workbench.comparison.grid import Grid
from workbench.comparison.pairs import PairedFigures
from workbench.csv_cells import plain_cell


def figures_table(grid: Grid) -> str:
    """A row per policy and task that has figures: who flew what, success and return with bounds, causes, command."""
    missiles = sorted({number for cell in grid.cells.values() for number in cell.task.missiles})
    causes = [*(f"shot_down_{number}" for number in missiles), *FAILURES]
    rows = []
    for (spec, task), cell in grid.cells.items():
        figures = cell.figures
        if figures is None:
            continue
        low, high = figures.return_ci95 or (None, None)
        rows.append({
            "policy": spec, "flown": cell.entry.policy, "policy_digest": cell.entry.digest, "task": task,
            "masked": " ".join(map(str, sorted(cell.task.masked))), "scenario": cell.task.scenario.name,
            "scenario_digest": cell.task.scenario.digest, "episodes": figures.episodes, "seed": grid.seed,
            "success_rate": figures.success_rate, "success_low": figures.success_ci95[0],
            "success_high": figures.success_ci95[1], "mean_return": figures.mean_return, "return_low": low,
            "return_high": high, "mean_length_s": figures.mean_length_s,
            **{cause: figures.causes.get(cause, 0) for cause in causes},
            "source": "shipped result set" if figures.shipped else "flown here", "note": cell.entry.note,
            "command": figures.command,
        })  # fmt: skip
    return _csv(rows)


def pairs_table(a: str, b: str, pairs: Mapping[str, PairedFigures]) -> str:
    """A row per task: engagements won by both, one or none of A and B, and the differences A − B with their bounds."""
    rows = []
    for task, figures in pairs.items():
        differences = {"success": figures.success_difference, "return": figures.return_difference}
        bounds = {
            f"{name}_{part}": value
            for name, values in differences.items()
            for part, value in zip(("difference", "low", "high"), values, strict=True)
        }
        counts = {name: getattr(figures, name) for name in ("both", "only_a", "only_b", "neither")}
        rows.append({"task": task, "a": a, "b": b, "episodes": figures.episodes, **counts, **bounds,
                     "mcnemar_p": figures.p_value})  # fmt: skip
    return _csv(rows)


def engagements_table(evaluations: Iterable[Evaluation]) -> str:
    """A row per engagement: seed and episode that fix its initial state, and how it went."""
    rows = []
    for evaluation in evaluations:
        results = evaluation.results
        if results is None:
            continue
        about = {"policy": evaluation.policy, "masked": " ".join(map(str, evaluation.mask)),
                 "scenario": evaluation.scenario, "seed": evaluation.seed}  # fmt: skip
        for i, episode in enumerate(results.episode):
            miss_m = float(results.closest_m[i])
            rows.append({
                **about, "episode": int(episode), "outcome": Outcome(int(results.outcome[i])).name.lower(),
                "killer": int(results.killer[i]) or None, "return": round(float(results.episode_return[i]), 3),
                "steps": int(results.steps[i]), "missiles_evaded": int(results.solved[i]),
                "closest_m": miss_m if np.isfinite(miss_m) else None,
            })  # fmt: skip
    return _csv(rows)


def _csv(rows: Sequence[Mapping[str, Any]]) -> str:
    text = io.StringIO()
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    return text.getvalue()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else plain_cell(value)
