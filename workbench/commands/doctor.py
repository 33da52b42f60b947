"""`workbench doctor`: what works on this machine, what is missing, and how to get it."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from packaging.requirements import Requirement

from workbench.terminal import print_json, print_table

DISTRIBUTION = "submas-workbench"
FREE_GB = 2.0
REINSTALL = "install again: make run, or pip install -e . -c constraints.txt"


@dataclass(frozen=True)
class Args:
    """Check this machine: versions, the simulator, the learner's matrix products, viewer, folders, policies."""

    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """One JSON object instead of a table."""


@dataclass(frozen=True)
class Check:
    """One thing looked at."""

    name: str
    ok: bool
    found: str
    needed: bool = True
    """Whether the workbench can do without."""
    advice: str = ""
    """The way out when it is not ok."""


class Missing(Exception):
    """What is not there, and the way out."""

    def __init__(self, found: str, advice: str) -> None:
        super().__init__(found)
        self.advice = advice


def run(args: Args) -> int:
    """0 when everything needed is there, else 1."""
    checks = [*_dependencies(), *(_look(*each) for each in _probes(args.runs))]
    ok = all(check.ok for check in checks if check.needed)
    if args.json:
        print_json({"ok": ok, "checks": [asdict(check) for check in checks]})
    else:
        words = {True: "ok", False: "MISSING"}
        rows = [(words[c.ok] if c.ok or c.needed else "none", c.name, c.found, c.advice) for c in checks]
        print_table(("", "what", "found", "way out"), rows)
    return 0 if ok else 1


def _probes(runs: Path) -> list[tuple[str, Callable[[], str], bool]]:
    """Name, what looks (and raises when it is missing), whether it is needed."""
    return [
        ("Python", _python, True),
        ("simulator kernel", _kernel, True),
        ("matrix products", _matmul, True),
        ("graphics card", _gpu, False),
        ("shipped policies", _policies, True),
        ("runs folder", lambda: _writable(runs), True),
        ("free disk", lambda: _disk(runs), False),
        ("Rerun viewer", _viewer, False),
        ("Chromium", _chromium, False),
    ]


def _look(name: str, probe: Callable[[], str], needed: bool) -> Check:
    try:
        return Check(name, True, probe(), needed)
    except Missing as missing:
        return Check(name, False, str(missing), needed, missing.advice)
    except Exception as error:
        return Check(name, False, f"{type(error).__name__}: {error}", needed, REINSTALL)


def _dependencies() -> Iterator[Check]:
    try:
        wanted = importlib.metadata.requires(DISTRIBUTION) or []
    except importlib.metadata.PackageNotFoundError:
        yield Check(DISTRIBUTION, False, "not installed", advice="pip install -e . -c constraints.txt")
        return
    for requirement in map(Requirement, wanted):
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield _dependency(requirement)


def _dependency(requirement: Requirement) -> Check:
    try:
        version = importlib.metadata.version(requirement.name)
    except importlib.metadata.PackageNotFoundError:
        return Check(requirement.name, False, "not installed", advice=REINSTALL)
    if requirement.specifier.contains(version, prereleases=True):
        return Check(requirement.name, True, version)
    return Check(requirement.name, False, f"{version}, needs {requirement.specifier}", advice=REINSTALL)


def _python() -> str:
    return f"{platform.python_version()} on {platform.machine()}, {os.cpu_count()} cores"


def _kernel() -> str:
    import numpy as np

    from sim.task import task_for
    from sim.world import World

    world = World(task_for("default", ""), lanes=64)
    world.reset()
    world.step(np.zeros(64, np.float32))
    step_s = _timed_s(lambda: world.step(np.zeros(64, np.float32)))
    return f"64 worlds step in {1e3 * step_s:.1f} ms"


def _matmul() -> str:
    import torch

    from agents.numerics import prepare_torch

    route = prepare_torch()
    left, right = torch.ones(128, 256), torch.ones(256, 256)
    fastest_s = min(_timed_s(lambda: torch.mm(left, right)) for _ in range(50))
    return f"{2 * 128 * 256 * 256 / fastest_s / 1e9:.0f} GFLOP/s on one thread ({route})"


def _timed_s(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def _gpu() -> str:
    import torch

    if not torch.cuda.is_available():
        raise Missing("none", "nothing to do: everything runs on the processor")
    return torch.cuda.get_device_name()


def _policies() -> str:
    from workbench.policies import resolve_policy, shipped_policies

    names = shipped_policies()
    if not names:
        raise Missing("none", "get assets/policies from the repository")
    for name in names:
        resolve_policy(name)
    return ", ".join(names)


def _writable(runs: Path) -> str:
    try:
        runs.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=runs):
            return str(runs.absolute())
    except OSError as error:
        raise Missing(f"{runs.absolute()}: {error.strerror}", "choose another with --runs") from error


def _disk(runs: Path) -> str:
    there = next(folder for folder in (runs.absolute(), *runs.absolute().parents) if folder.is_dir())
    free_gb = shutil.disk_usage(there).free / 1e9
    if free_gb < FREE_GB:
        raise Missing(f"{free_gb:.1f} GB", f"free some space: runs and recordings want {FREE_GB:.0f} GB")
    return f"{free_gb:.0f} GB"


def _viewer() -> str:
    from workbench.viewer_files import ensure_viewer

    return str(ensure_viewer())


def _chromium() -> str:
    from workbench.chromium import find_chromium

    found = find_chromium()
    if found is None:
        raise Missing("none", "only for films of flights and browser tests: apt-get install chromium, or set CHROMIUM")
    return str(found)
