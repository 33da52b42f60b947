"""What `workbench doctor` asks of the machine: packages, simulator, learner, viewers. Each probe says what it found."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

DISTRIBUTION = "submas-workbench"
REINSTALL = "install again: make run, or pip install -e . -c constraints.txt"
MOST_NAMED = 3


class Missing(Exception):
    """What is wrong, and what to do about it."""

    def __init__(self, found: str, advice: str) -> None:
        super().__init__(found)
        self.advice = advice


def dependencies() -> Iterator[tuple[str, Callable[[], str], bool]]:
    """A probe for every package that the installed metadata declares."""
    try:
        wanted = importlib.metadata.requires(DISTRIBUTION) or []
    except importlib.metadata.PackageNotFoundError:
        yield DISTRIBUTION, _not_installed, True
        return
    for requirement in map(Requirement, wanted):
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            yield requirement.name, partial(dependency, requirement), True


def _not_installed() -> str:
    raise Missing("not installed", "pip install -e . -c constraints.txt")


def dependency(requirement: Requirement) -> str:
    """The installed version, if it is one that is declared."""
    try:
        version = importlib.metadata.version(requirement.name)
    except importlib.metadata.PackageNotFoundError:
        raise Missing("not installed", REINSTALL) from None
    if not requirement.specifier.contains(version, prereleases=True):
        raise Missing(f"{version}, needs {requirement.specifier}", REINSTALL)
    return version


def python() -> str:
    """Version and machine."""
    version, wanted = platform.python_version(), "3.11"
    if not SpecifierSet(f">={wanted}").contains(version, prereleases=True):
        raise Missing(version, f"install Python {wanted} or newer, then: make PYTHON=python{wanted}")
    return f"{version} on {platform.machine()}, {os.cpu_count()} cores"


def tested_versions(pins: Path = Path(__file__).parents[2] / "constraints.txt") -> str:
    """Whether the packages are those this version was tested with; bits of a training depend on them."""
    if not pins.is_file():
        return "not known here (no constraints.txt beside the package)"
    lines = (line.partition("#")[0].strip() for line in pins.read_text("utf-8").splitlines())
    other = [words for line in filter(None, lines) if (words := _other_version(Requirement(line)))]
    if other:
        more = f" and {len(other) - MOST_NAMED} more" if len(other) > MOST_NAMED else ""
        raise Missing(", ".join(other[:MOST_NAMED]) + more, REINSTALL)
    return "all as tested"


def _other_version(pin: Requirement) -> str:
    try:
        version = importlib.metadata.version(pin.name)
    except importlib.metadata.PackageNotFoundError:
        return ""  # belongs to an extra
    known = pin.specifier.contains(version, prereleases=True)
    return "" if known else f"{pin.name} {version} (tested: {str(pin.specifier).removeprefix('==')})"


def kernel() -> str:
    """Compile and step the simulator."""
    import numpy as np

    from sim.task import task_for
    from sim.world import World

    world = World(task_for("default", ""), lanes=64)
    world.reset()
    world.step(np.zeros(64, np.float32))
    step_s = timed_s(lambda: world.step(np.zeros(64, np.float32)))
    return f"64 worlds step in {1e3 * step_s:.1f} ms"


def warp_device() -> str:
    """What Warp computes on."""
    import warp

    from sim.device import start_warp

    start_warp()
    if not warp.is_cpu_available():
        raise Missing("Warp cannot compile for this processor", "pip install --force-reinstall warp-lang")
    return f"{', '.join(str(device) for device in warp.get_devices())} (warp {warp.__version__})"


def matrix_products() -> str:
    """The route of float32 products that a training would take here, its speed, and that it is exact."""
    import torch

    from agents.numerics import WORST_ERROR, prepare_torch, relative_error

    route = prepare_torch()
    left, right = torch.ones(128, 256), torch.ones(256, 256)
    error = relative_error(torch.rand(128, 256), torch.rand(256, 256))
    if error > WORST_ERROR:
        raise Missing(f"wrong by {error:.1e} on the route {route}", "trainings would not be the paper's; " + REINSTALL)
    fastest_s = min(timed_s(lambda: torch.mm(left, right)) for _ in range(50))
    return f"{2 * 128 * 256 * 256 / fastest_s / 1e9:.0f} GFLOP/s on one thread ({route})"


def timed_s(work: Callable[[], object]) -> float:
    """How long it takes [s]."""
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def graphics_card() -> str:
    """Its name."""
    import torch

    if not torch.cuda.is_available():
        raise Missing("none", "nothing to do: everything runs on the processor")
    return torch.cuda.get_device_name()


def policies() -> str:
    """Those that are shipped, each read as a flight would."""
    from workbench.policies import resolve_policy, shipped_policies

    names = shipped_policies()
    if not names:
        raise Missing("none", "get assets/policies from the repository")
    for name in names:
        resolve_policy(name)
    return ", ".join(names)


def viewer() -> str:
    """Where its files are; fills the folder when it is empty."""
    from workbench.viewer_files import ensure_viewer

    return str(ensure_viewer())


def chromium() -> str:
    """The program for films and browser tests."""
    from workbench.chromium import find_chromium

    found = find_chromium()
    if found is None:
        chosen = os.environ.get("CHROMIUM")
        advice = "only for films of flights and browser tests: apt-get install chromium, or set CHROMIUM"
        raise Missing(f"{chosen} is no program" if chosen else "none", advice)
    return str(found)
