"""What is loaded, and when."""

from __future__ import annotations

import logging
import subprocess
import sys

import pytest

from workbench import warm_up as module
from workbench.launcher import environment
from workbench.warm_up import FIRST, LATER

PAGES = [name for name in (*FIRST, *LATER) if name.startswith("workbench.pages.")]
HEAVY = ("matplotlib", "rerun", "torch", "pyarrow", "stable_baselines3")
"""Half a second and more each, and needed by a few visitors only: for pictures, recordings, trainings, tables."""


def test_no_page_loads_what_only_some_visitors_need() -> None:
    code = f"""
import importlib, sys
for name in {PAGES}:
    importlib.import_module(name)
print([name for name in {HEAVY} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment())
    assert done.stdout.strip() == "[]"


def test_every_page_is_warmed_up() -> None:
    from workbench.app import PAGES as pages

    assert {name.rpartition(".")[2] for name in PAGES} == set(pages)


def test_a_failure_is_logged_and_no_more(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(module, "FIRST", ("no_such_module",))
    with caplog.at_level(logging.WARNING):
        module.warm_up(None, later_s=0.0)  # type: ignore[arg-type]
    assert "no_such_module" in caplog.text
