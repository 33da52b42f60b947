"""The cache of this user: files that can be made again, and how many of a kind are kept."""

from __future__ import annotations

import os
from pathlib import Path


def cache_folder() -> Path:
    """Where derived files of this user live: `$XDG_CACHE_HOME/submas-workbench`, usually under `~/.cache`."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "submas-workbench"


def keep_newest(folder: Path, pattern: str, count: int) -> None:
    """Remove all but the `count` files of a folder that were written last, of those whose names match a pattern."""
    found = []
    for path in folder.glob(pattern):
        try:
            found.append((path.stat().st_mtime, path))
        except FileNotFoundError:  # another process removes as well
            continue
    for _age, path in sorted(found, reverse=True)[count:]:
        path.unlink(missing_ok=True)
