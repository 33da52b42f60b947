"""Where numbers come from: digests of the scenario, of the source that flew and of policy files."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from workbench.reproduce.protocol import SCENARIO

DIGITS = 12
FLYING = ("evaluation", "evasion", "expert", "features", "policy")
"""Modules of `agents` that a flight depends on."""


@dataclass(frozen=True)
class Provenance:
    """What all numbers of one session have in common."""

    scenario_digest: str
    source_digest: str
    code_version: str


def provenance() -> Provenance:
    """Of this scenario and this source."""
    from agents.card import code_version
    from sim.scenario_file import load_scenario

    return Provenance(load_scenario(SCENARIO).digest, source_digest(), code_version())


@cache
def source_digest() -> str:
    """Identifies the source of the simulator and of what flies in it: after any change a number is flown again."""
    import agents
    import sim

    simulator, learners = (Path(str(package.__file__)).parent for package in (sim, agents))
    paths = [*sorted(simulator.rglob("*.py")), *(learners / f"{name}.py" for name in FLYING)]
    content = hashlib.sha256()
    for path in paths:
        content.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return content.hexdigest()[:DIGITS]


def file_digest(path: Path) -> str:
    """Identifies a policy file by its bytes."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:DIGITS]
