"""Start-up of Warp, without its notice that this machine has no CUDA driver."""

from __future__ import annotations

import os
import sys
from functools import cache

import warp as wp


@cache
def start_warp() -> None:
    """Initialise Warp once.

    Its native library writes the notice straight to standard error, on every machine without an NVIDIA GPU and with
    no switch to silence it; so that descriptor points nowhere for these milliseconds. Failures still raise.
    """
    sys.stderr.flush()
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        wp.init()
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)
