"""Importing is free of side effects: nothing is printed, opened, started or fetched, and the layers stay apart."""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LEARNING = {"torch", "safetensors", "stable_baselines3"}
SCREENS = {"panel", "bokeh", "viser", "rerun"}
LOOK = """
import importlib, json, pkgutil, random, sys, threading
import numpy, psutil
import rich.style  # draws a number of its own, and Stable-Baselines3 brings it along
packages = sys.argv[1:]
random.seed(1), numpy.random.seed(1)
before = random.getstate(), numpy.random.get_state()[1].tolist()
for package in packages:
    for module in pkgutil.walk_packages([package], package + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
print(json.dumps({
    "modules": sorted({name.partition(".")[0] for name in sys.modules}),
    "threads": [thread.name for thread in threading.enumerate()],
    "sockets": [str(connection) for connection in psutil.Process().net_connections("inet")],
    "random": before == (random.getstate(), numpy.random.get_state()[1].tolist()),
}))
"""


@cache
def look(*packages: str) -> dict[str, list[str] | bool]:
    """What a fresh process holds after importing every module of these packages."""
    command = [sys.executable, "-c", LOOK, *packages]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, timeout=300)
    assert done.stderr == ""
    return json.loads(done.stdout)


def test_importing_everything_starts_nothing() -> None:
    found = look("sim", "agents", "layouts", "workbench")
    assert found["threads"] == ["MainThread"]
    assert found["sockets"] == []


@pytest.mark.parametrize("package", ["sim", "agents"])
def test_importing_draws_no_random_numbers(package: str) -> None:
    assert look(package)["random"]


@pytest.mark.parametrize(
    ("package", "forbidden"),
    [
        ("sim", LEARNING | SCREENS | {"agents", "layouts", "workbench"}),
        ("agents", SCREENS | {"layouts", "workbench"}),
        ("layouts", LEARNING | {"agents", "workbench"}),
    ],
)
def test_layers_stay_apart_even_through_others(package: str, forbidden: set[str]) -> None:
    # lint-imports reads the source; this also sees what libraries drag in.
    assert not forbidden & set(look(package)["modules"])
