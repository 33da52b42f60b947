"""Which runs of the runs folder are the trainings that a plan asks for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from agents.config import VARIANTS, TrainingConfig
from workbench.run_files import RunFileError, read_json
from workbench.runs import Run, RunStore

Key = tuple[tuple[str, Any], ...]
"""What two trainings have in common that must give the same policy."""

_RANK = {"finished": 0, "running": 1, "stalled": 1, "queued": 2, "interrupted": 3, "paused": 3, "stopped": 3}
_FAILED = 4


def training_key(config: TrainingConfig) -> Key:
    """All of a configuration but its name, and but a guide that nothing is learned from.

    The version of the code is not part of it: a run of an older version counts. Delete it to have it trained again.
    """
    values = config.to_json()
    del values["name"]
    variant = VARIANTS[config.variant]
    if not (variant.distillation or variant.reuse):
        values["guide"] = ""
    return tuple(sorted(values.items()))


def matching_runs(store: RunStore, keys: Iterable[Key], scenario_digest: str) -> dict[Key, Run]:
    """For each of these trainings the run that is furthest: finished, running, queued, halted, or failed; newest first.

    A finished run counts only if it was trained in this very scenario and still has the policies of all its stages:
    runs may have been copied together from several folders.
    """
    wanted = set(keys)
    found: dict[Key, tuple[int, Run]] = {}
    for run in store.list():
        if run.problem or (key := training_key(run.config)) not in wanted:
            continue
        rank = _RANK.get(run.state.state, _FAILED)
        if rank == 0 and (_trained_in(run) != scenario_digest or not _whole(run)):
            continue
        if key not in found or rank < found[key][0]:
            found[key] = (rank, run)
    return {key: run for key, (_, run) in found.items()}


def _whole(run: Run) -> bool:
    """Whether every stage left its policy."""
    config = run.config
    stages = config.missiles if config.curriculum else 1
    return sum(1 for _ in (run.path / "policies").glob("*.safetensors")) >= stages


def _trained_in(run: Run) -> str:
    """Digest of the scenario in which a finished run's policy was trained; empty when its card cannot be read."""
    try:
        return str(read_json(run.path / "policy.json").get("scenario_digest", ""))
    except RunFileError:
        return ""
