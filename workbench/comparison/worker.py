"""A process that flies comparisons: one piece of work per line in, its progress and its end per line out."""

from __future__ import annotations

import json
import os
import sys
import time
import traceback
from pathlib import Path
from typing import Any, TextIO

from sim.errors import SubMasError
from workbench.comparison.cache import ComparisonCache
from workbench.comparison.work import Work

EVERY_S = 0.1
"""Progress is told so often [s]."""


def main(runs: Path, folder: Path) -> None:
    """Work until standard input ends; the results go into the cache's folder."""
    said = _private_output()
    cache = ComparisonCache(folder)
    for line in sys.stdin:
        _say(said, **_flown(Work.from_json(json.loads(line)), runs, cache, said))


def _flown(work: Work, runs: Path, cache: ComparisonCache, said: TextIO) -> dict[str, Any]:
    from workbench.comparison.flights import do

    told_s = 0.0

    def tell(share: float) -> None:
        nonlocal told_s
        if time.monotonic() - told_s > EVERY_S:
            told_s = time.monotonic()
            _say(said, share=round(share, 4))

    try:
        cache.write(work, do(work, runs, tell))
    except SubMasError as error:
        return {"error": str(error)}
    except Exception as error:
        traceback.print_exc()
        return {"error": f"{type(error).__name__}: {error}"}
    return {"done": True}


def _private_output() -> TextIO:
    """Standard output for us alone: whatever a library prints goes to standard error."""
    said = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return said


def _say(said: TextIO, **words: Any) -> None:
    try:
        said.write(json.dumps(words) + "\n")
        said.flush()
    except BrokenPipeError:
        os._exit(0)  # nobody listens any more


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
