"""Warp starts without a word: commands print one JSON object on standard output and nothing else anywhere."""

from __future__ import annotations

import subprocess
import sys

import pytest

FLY = """
from sim.world import World
from sim.task import task_for
World(task_for(), 2).step([0.1, 0.2])
"""


def test_flying_prints_nothing() -> None:
    done = subprocess.run([sys.executable, "-c", FLY], capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_standard_error_is_back_after_the_start(capfd: pytest.CaptureFixture[str]) -> None:
    from sim.device import start_warp

    start_warp.cache_clear()
    start_warp()
    print("still here", file=sys.stderr, flush=True)
    assert "still here" in capfd.readouterr().err


def test_importing_sim_starts_nothing() -> None:
    # No device is opened and no kernel compiled by an import.
    code = "import sim.environment, sim.trajectory, warp; assert warp._src.context.runtime is None"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
