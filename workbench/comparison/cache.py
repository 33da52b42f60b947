"""Results of comparisons as files: JSON under their work's name, read with distrust, the oldest removed."""

from __future__ import annotations

import dataclasses
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation
from workbench.cache_folder import cache_folder, keep_newest
from workbench.comparison.work import Work
from workbench.run_files import strict, write_bytes

KEPT = 1500
"""Results kept (about 25 kB for a thousand engagements); the oldest go first."""
SIZE_LIMIT = 64_000_000
"""Largest file that is read [bytes]."""
WHOLE = ("episode", "outcome", "killer", "steps", "solved")
REAL = ("episode_return", "closest_m")
NEVER = -1.0
"""Closest approach in a file where no missile was launched: JSON has no infinity."""


class ComparisonCache:
    """The folder of one user; results of equal work are equal files."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or cache_folder() / "comparisons"

    def has(self, work: Work) -> bool:
        """Whether there is a result."""
        return self._path(work).is_file()

    def read(self, work: Work) -> dict[str, Any] | None:
        """The result, or None if there is none that can be read; one that cannot is removed."""
        path = self._path(work)
        try:
            if path.stat().st_size > SIZE_LIMIT:
                raise ValueError("too large")
            values = json.loads(path.read_bytes())
            if not isinstance(values, dict):
                raise ValueError("no object")
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError):
            path.unlink(missing_ok=True)
            return None
        os.utime(path)  # the oldest files are those nobody looked at
        return values

    def evaluation(self, work: Work) -> Evaluation | None:
        """A counted evaluation with its single episodes, or None while there is none."""
        values = self.read(work)
        if values is None:
            return None
        try:
            return evaluation_from_json(values)
        except (KeyError, TypeError, ValueError):
            self._path(work).unlink(missing_ok=True)
            return None

    def write(self, work: Work, result: dict[str, Any]) -> None:
        """Keep a result, the whole of it or nothing.

        Raises:
            RunFileError: the file cannot be written.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        content = json.dumps(strict(result), allow_nan=False, separators=(",", ":"))
        write_bytes(self._path(work), content.encode())
        keep_newest(self.folder, "*.json", KEPT)

    def _path(self, work: Work) -> Path:
        return self.folder / f"{work.name}.json"


def evaluation_to_json(evaluation: Evaluation) -> dict[str, Any]:
    """Figures and single episodes as plain JSON values; distances in centimetres' precision."""
    results = evaluation.results
    assert results is not None, "an evaluation without its episodes is not kept"
    closest_m = np.where(np.isfinite(results.closest_m), results.closest_m, NEVER).round(2)
    columns = {name: getattr(results, name).tolist() for name in WHOLE}
    columns |= {"episode_return": results.episode_return.round(3).tolist(), "closest_m": closest_m.tolist()}
    return {"figures": evaluation.to_json(), "episodes": columns}


def evaluation_from_json(values: dict[str, Any]) -> Evaluation:
    """The evaluation that `evaluation_to_json` wrote.

    Raises:
        KeyError, TypeError, ValueError: anything else.
    """
    figures, columns = dict(values["figures"]), values["episodes"]
    for name in ("mask", "missiles", "success_ci95"):
        figures[name] = tuple(figures[name])
    arrays: dict[str, Any] = {name: np.asarray(columns[name], dtype=np.int64) for name in WHOLE}
    arrays |= {name: np.asarray(columns[name], dtype=np.float32) for name in REAL}
    if {array.shape for array in arrays.values()} != {(figures["episodes"],)}:
        raise ValueError("columns of other lengths than there are episodes")
    arrays["closest_m"] = np.where(arrays["closest_m"] < 0.0, np.inf, arrays["closest_m"]).astype(np.float32)
    known = {field.name for field in dataclasses.fields(Evaluation)}
    return Evaluation(**{k: v for k, v in figures.items() if k in known}, results=EpisodeResults(**arrays))
