"""Many seeds of the whole curriculum together: how long it takes and what it reaches, as a small JSON file.

The seeds are ordinary runs, trained by `workbench.stacked_training`: the pages show them, and Ctrl-C stops them.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from agents.config import TrainingConfig
from workbench.run_files import RunFileError, read_json
from workbench.runs import Run, RunStore
from workbench.stack_options import StackOptions
from workbench.stages import summarise


def bench_curriculum(store: RunStore, seeds: int, profile: str, options: StackOptions) -> tuple[dict[str, Any], bool]:
    """Train `seeds` seeds of the curriculum together and follow them; the result, and whether it was interrupted.

    Raises:
        ConfigError: there is no such device or profile.
        RunsFolderError: the runs folder cannot be written.
    """
    from agents.stacked.device import checked_device
    from workbench.engine import LocalEngine
    from workbench.follow import follow
    from workbench.stacked_launch import launch_stacked

    device = checked_device(options.device)
    configs = [
        TrainingConfig.from_json({"curriculum": True, "seed": seed, "profile": profile, "name": f"bench {device}"})
        for seed in range(seeds)
    ]
    runs = launch_stacked(store, configs, options)
    interrupted = follow(LocalEngine(store), runs)
    return curriculum_result(runs, options), interrupted


def curriculum_result(runs: Sequence[Run], options: StackOptions) -> dict[str, Any]:
    """Time and success of runs that were trained together, as plain JSON values.

    `success_rate` is that of each seed's final policy on episodes that had no part in training or choosing it; None
    where a run did not come to its end.
    """
    each = [_one(run) for run in runs]
    rates = [one["success_rate"] for one in each if one["success_rate"] is not None]
    wall_s = max((one["wall_s"] for one in each), default=0.0)
    updates = sum(one["updates"] for one in each)
    return {
        "device": options.device,
        "simulator": options.simulator,
        "seeds": len(runs),
        "profile": runs[0].config.profile,
        "wall_s": wall_s,
        "updates": updates,
        "agent_updates_per_s": updates / max(wall_s, 1e-9),
        "success_rate_mean": sum(rates) / len(rates) if rates else None,
        "success_rate_least": min(rates, default=None),
        "runs": each,
        "versions": {name: version(name) for name in ("torch", "warp-lang", "numpy")},
        "cores": os.cpu_count(),
    }


def write_result(result: dict[str, Any], path: Path) -> None:
    """Write the result as JSON.

    Raises:
        RunFileError: it cannot be written.
    """
    try:
        path.write_text(json.dumps(result, indent=1, allow_nan=False) + "\n")
    except OSError as error:
        raise RunFileError(f"{path} cannot be written: {error.strerror}") from error


def _one(run: Run) -> dict[str, Any]:
    rows, state = run.metrics(), run.state
    # Steps and updates begin at 0 with every stage.
    last = {row["stage"]: row for row in rows}.values()
    return {
        "id": run.id,
        "seed": run.config.seed,
        "state": state.state,
        "wall_s": state.wall_s,
        "updates": sum(row["updates"] for row in last),
        "env_steps": sum(row["env_steps"] for row in last),
        "stages": summarise(rows),
        "success_rate": _judged(run) if state.state == "finished" else None,
        "error": state.error,
    }


def _judged(run: Run) -> float | None:
    with contextlib.suppress(RunFileError):
        evaluation = read_json(run.path / "policy.json").get("evaluation")
        if isinstance(evaluation, dict):
            return evaluation.get("success_rate")
    return None
