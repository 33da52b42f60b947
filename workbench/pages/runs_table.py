"""The table of the Runs page: one row per run, the damaged ones with their reason."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import pandas as pd
import panel as pn

from layouts.theme import POLICY_A
from workbench.policies import title, what_is_learned
from workbench.runs import Run
from workbench.scenarios import other_scenario

if TYPE_CHECKING:
    from agents.config import TrainingConfig

COLUMNS = {
    "state": "State",
    "training": "Training",
    "name": "Name",
    "variant": "Variant",
    "profile": "Profile",
    "seed": "Seed",
    "success": "Success %",
    "progress": "Progress",
    "started": "Started",
    "minutes": "Minutes",
    "run": "Run",
}
"""Columns of the table and their titles; every cell is data, never markup (Tabulator's default)."""
WIDTHS = {
    "state": 120, "training": 235, "name": 110, "variant": 85, "profile": 85, "seed": 70, "success": 118,
    "progress": 112, "started": 160, "minutes": 90, "run": 200,
}  # fmt: skip
SIGNS = {"queued": "…", "running": "▶", "stopped": "■", "finished": "✓", "failed": "✗", "interrupted": "✗"}
"""Signs before a state, so that it is seen without reading."""
FILTERS: dict[str, Any] = {
    name: {"type": "input", "func": "like", "placeholder": "filter"}
    for name in ("state", "training", "name", "variant", "profile", "seed", "run")
}
PROGRESS = {"type": "progress", "max": 100, "color": POLICY_A, "legend": True, "legendColor": "currentColor"}
SELECTED_CSS = """
.tabulator .tabulator-row.tabulator-selected { color: inherit;
  background: color-mix(in srgb, var(--panel-primary-color) 32%, transparent) !important }
"""
UNREADABLE = "unreadable"


def runs_frame(runs: Sequence[Run]) -> pd.DataFrame:
    """One row per run, in the order given."""
    return pd.DataFrame([_cells(run) for run in runs], columns=list(COLUMNS))


def _cells(run: Run) -> dict[str, Any]:
    if run.problem:
        return {"run": run.id, "state": f"✗ {UNREADABLE}", "training": run.problem, "progress": 0}
    state, config = run.state, run.config
    best = state.best_success_rate
    return {
        "state": f"{SIGNS[state.state]} {state.state}",
        "training": _training(config),
        "name": config.name,
        "variant": config.variant,
        "profile": config.profile,
        "seed": str(config.seed),
        "success": None if best is None else round(100 * best, 1),
        "progress": round(100 * state.progress),
        "started": (state.started or state.created)[:19].replace("T", " "),
        "minutes": round(state.wall_s / 60, 1),
        "run": run.id,
    }


def _training(config: TrainingConfig) -> str:
    """What is learned, and on which scenario where that is not the default one."""
    last = config.missiles
    stage = "Stage: missile 1" if last == 1 else f"Stage: missiles 1–{last}"
    usual = "Curriculum" if config.curriculum else stage
    what = what_is_learned(config) if config.mask or config.order else usual
    return " · ".join(filter(None, [what, other_scenario(config.scenario)]))


def runs_table(frame: pd.DataFrame, height: int) -> pn.widgets.Tabulator:
    """The table, sorted newest first, with a filter under each title."""
    return pn.widgets.Tabulator(
        frame,
        titles=COLUMNS,
        widths=WIDTHS,
        header_filters=FILTERS,
        formatters={
            "progress": {
                "type": "progress",
                "max": 100,
                "color": "#2f86ff",
                "legend": True,
                "legendColor": "currentColor",
            }
        },
        text_align={name: "right" for name in ("success", "minutes")},
        show_index=False,
        disabled=True,
        selectable=1,
        row_height=36,
        pagination="local",
        page_size=50,
        height=height,
        layout="fit_data_stretch",
        sizing_mode="stretch_width",
        stylesheets=[SELECTED_CSS],
        margin=0,
    )


def describe(run: Run) -> list[tuple[str, str]]:
    """A run's configuration and state, as pairs of words for a person."""
    if run.problem:
        return [("Run", run.id), ("Problem", run.problem), ("Folder", str(run.path))]
    state, config = run.state, run.config
    pairs = [("Training", title(config)), ("Run", run.id), ("State", state.state)]
    if state.error:
        pairs.append(("Reason", state.error))
    pairs += [("Scenario", config.scenario), ("Guide", config.guide or "the next easier task's")]
    return [*pairs, ("Folder", str(run.path))]
