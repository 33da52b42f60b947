"""Folders for a while: removed afterwards, or by the next that needs one here if its process was killed."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from workbench.run_files import is_locked, take_lock

HELD: Final = "held.lock"


@contextlib.contextmanager
def scratch(prefix: str, base: Path | None = None) -> Iterator[Path]:
    """A new folder, nobody else's, below `base` (default: where temporary files go)."""
    base = base or Path(tempfile.gettempdir())
    for old in base.glob(f"{prefix}*"):
        with contextlib.suppress(OSError):
            if old.stat().st_uid == os.getuid() and (old / HELD).exists() and not is_locked(old / HELD):
                shutil.rmtree(old, ignore_errors=True)
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=base))
    lock = take_lock(folder / HELD)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)
