"""One run as the index knows it: what is searched, sorted and listed, read once from its folder."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.run_files import READ_LIMIT_BYTES, RunFileError, read_json
from workbench.run_folder import Run, problem_of
from workbench.run_notes import FILE as NOTES
from workbench.run_notes import read_notes

UNREADABLE = "unreadable"
TAIL_BYTES = 64 * 1024
WATCHED = ("config.json", "state.json", NOTES)
"""Files that a person may change in place; the workbench itself replaces them, which their folder tells."""


@dataclass(frozen=True)
class RunRecord:
    """One run folder, good or damaged, living or in the trash."""

    folder: str
    """Path below the runs folder, `/` between its parts: what tells records apart."""
    id: str
    trashed: int
    """1 in the trash, else 0."""
    problem: str = ""
    """Why this run cannot be shown properly; empty for a good one."""
    state: str = UNREADABLE
    running: int = 0
    """1 where `state.json` says that somebody works on it, which only the run's lock can confirm."""
    name: str = ""
    notes: str = ""
    tags: str = ""
    """Each tag between line feeds, so that a whole one can be looked for."""
    scenario: str = ""
    task: str = ""
    """What is learned, in two words."""
    missiles: int = 0
    """How many missiles the run's last task has."""
    subtasks: str = ""
    """Their numbers, as in "1,2,3"."""
    curriculum: int = 0
    variant: str = ""
    profile: str = ""
    seed: int | None = None
    guide: str = ""
    success: float | None = None
    """Best held-out success rate of the latest stage, 0..1."""
    mean_return: float | None = None
    """Mean return of the best policy's evaluation."""
    progress: float = 0.0
    created: str = ""
    started: str = ""
    wall_s: float = 0.0
    steps: int | None = None
    """Decision steps of all stages so far."""
    epochs: int | None = None
    """Epochs of the latest stage."""
    error: str = ""
    has_policy: int = 0

    @property
    def tag_list(self) -> list[str]:
        """Its tags in order."""
        return self.tags.strip("\n").split("\n") if self.tags else []

    @property
    def when(self) -> str:
        """When it began, else when it was asked for, ISO 8601."""
        return self.started or self.created

    @property
    def title(self) -> str:
        """Its name, else what it learns, else its id."""
        return self.name or self.task or self.id

    @property
    def haystack(self) -> str:
        """Everything a search looks at, in lower case."""
        seed = "" if self.seed is None else f"seed {self.seed}"
        words = (self.id, self.name, self.notes, self.tags, self.scenario, self.task, self.variant, self.profile)
        return "\n".join((*words, seed, self.guide, self.error, self.problem)).lower()


def read_record(path: Path, folder: str, trashed: bool) -> RunRecord:
    """What the run folder at `path` says now. Never raises: one bad run must not hide the others."""
    run = Run(path)
    head: dict[str, Any] = {"folder": folder, "id": path.name.partition(".")[0], "trashed": int(trashed)}
    problem = problem_of(run)
    if not path.is_symlink() and path.is_dir():
        notes = read_notes(path)
        head |= {"notes": notes.text, "tags": _between_lines(notes.tags)}
    if problem:
        return RunRecord(**head, problem=problem, created=_created(head["id"]))
    try:
        return RunRecord(**head, **_configured(run), **_reached(run))
    except RunFileError as error:  # it changed under our eyes
        return RunRecord(**head, problem=str(error), created=_created(head["id"]))


def _created(run_id: str) -> str:
    """When a run was asked for, as its id has it: where a damaged one stands among the others."""
    day, clock = run_id[:8], run_id[9:15]
    return f"{day[:4]}-{day[4:6]}-{day[6:]}T{clock[:2]}:{clock[2:4]}:{clock[4:]}"


def _between_lines(tags: tuple[str, ...]) -> str:
    return "\n".join(("", *tags, "")) if tags else ""


def _configured(run: Run) -> dict[str, Any]:
    config = run.config
    names = ("name", "scenario", "variant", "profile", "seed", "guide")
    return {
        **{name: getattr(config, name) for name in names},
        "missiles": len(config.subtasks),
        "subtasks": ",".join(map(str, config.subtasks)),
        "curriculum": int(config.curriculum),
        "task": task_words(config.curriculum, config.subtasks),
    }


def task_words(curriculum: bool, subtasks: Sequence[int]) -> str:
    """What a training learns: the chain up to these missiles, or the single stage with them."""
    row = list(range(1, len(subtasks) + 1))
    missiles = f"1–{len(row)}" if len(row) > 1 and list(subtasks) == row else ",".join(map(str, subtasks))
    return f"{'Curriculum' if curriculum else 'Stage'} {missiles}"


def _reached(run: Run) -> dict[str, Any]:
    state = run.state
    last = last_row(run.path / "metrics.jsonl")
    return {
        "state": state.state,
        "running": int(state.claimed or state.state in ("stalled", "interrupted")),
        "success": state.best_success_rate,
        "mean_return": _card_return(run.path),
        "progress": float(state.progress),
        "created": state.created,
        "started": state.started,
        "wall_s": float(state.wall_s),
        "steps": _steps(run, last),
        "epochs": _whole(last.get("epoch")),
        "error": state.error,
        "has_policy": int(run.policy_path() is not None),
    }


def _steps(run: Run, last: dict[str, Any]) -> int | None:
    """Decision steps of all stages. Each counts its own, so that behind the first one all rows are read."""
    if not last.get("stage"):
        return _whole(last.get("env_steps"))
    with contextlib.suppress(RunFileError):
        of_stages = {str(row.get("stage")): _whole(row.get("env_steps")) or 0 for row in run.metrics()}
        return _whole(sum(of_stages.values()))
    return None


def _card_return(path: Path) -> float | None:
    with contextlib.suppress(RunFileError):
        evaluation = read_json(path / "policy.json").get("evaluation")
        value = evaluation.get("mean_return") if isinstance(evaluation, dict) else None
        return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None
    return None


def _whole(value: object) -> int | None:
    # SQLite holds integers of 64 bits.
    fits = isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**63
    return int(value) if fits else None  # type: ignore[arg-type]


def last_row(path: Path) -> dict[str, Any]:
    """The last complete row of a file of JSON lines, read from its end; nothing where there is none."""
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(size - min(TAIL_BYTES, READ_LIMIT_BYTES), 0))
            tail = file.read(TAIL_BYTES)
        lines = tail[: tail.rfind(b"\n") + 1].splitlines()
        row = json.loads(lines[-1]) if lines else {}
    except (OSError, ValueError, RecursionError):
        return {}
    return row if isinstance(row, dict) else {}


def folder_stamp(path: str) -> str:
    """Differs once a file of the folder was made, replaced or removed; one look at the disk."""
    return _stamp(path)


def file_stamps(path: str) -> str:
    """Differs once one of the files was changed in place, which the folder's own time does not tell."""
    return " ".join(_stamp(f"{path}/{name}") for name in WATCHED)


def _stamp(path: str) -> str:
    try:
        stat = os.lstat(path)
    except OSError:
        return "-"
    return f"{stat.st_mtime_ns}:{stat.st_size}:{stat.st_ino}"
