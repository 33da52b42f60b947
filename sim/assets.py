"""Where the data files live: `assets/` beside the packages of a checkout, or the installed copy of it."""

from __future__ import annotations

import sys
from pathlib import Path


def asset_path(*parts: str) -> Path:
    """Path of a data file or folder, for example `asset_path("scenarios", "default.toml")`.

    Raises:
        FileNotFoundError: neither a checkout nor an installation holds an `assets` folder.
    """
    candidates = (
        Path(__file__).resolve().parents[1] / "assets",
        Path(sys.prefix) / "share/submas-workbench/assets",
    )
    for root in candidates:
        if root.is_dir():
            return root.joinpath(*parts)
    raise FileNotFoundError(f"no assets folder at {candidates[0]} or {candidates[1]}; reinstall submas-workbench")
