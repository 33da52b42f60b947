"""The clock of Rerun recordings, known to pages without loading Rerun."""

from __future__ import annotations

CLOCK = "sim_time"
"""Name of the timeline that all of a recording is on."""
