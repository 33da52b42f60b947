"""Pieces of work of a comparison: what is flown, and the name under which its result is kept."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask

Kind = Literal["evaluation", "survival", "tracks"]
KINDS: Final = ("evaluation", "survival", "tracks")
FORM: Final = 1
"""Version of what results look like; results of another version are flown again."""
NETWORK_WEIGHT, RULE_WEIGHT = 4.0, 1.0
"""How long engagements of a network take beside those of a rule: what the progress bar weighs them with."""
BRIEF_WEIGHT = 0.5
"""Likewise for maps of survival and tracks."""


class ComparisonError(SubMasError):
    """Something of a comparison could not be flown or read; the message says what."""


@dataclass(frozen=True, kw_only=True)
class Work:
    """One policy on one task: many engagements to count, a few to draw, or a map of shots."""

    kind: Kind
    policy: str
    """POLICY: a name, a run or a file."""
    policy_digest: str
    """Identifies the policy's file; empty for a rule."""
    scenario: str
    """SCENARIO: a name or a path."""
    scenario_digest: str
    mask: str
    """Masked missiles, as in `--mask`."""
    seed: int
    episodes: int = 0
    """How many engagements are counted."""
    numbers: tuple[int, ...] = ()
    """Episode numbers of the engagements that are drawn."""

    @property
    def name(self) -> str:
        """Name of the result: equal for equal flights, whatever run or path the policy was found under."""
        flown = dataclasses.asdict(self) | {"policy": self.policy_digest or self.policy, "scenario": ""}
        content = json.dumps([FORM, source(), flown], sort_keys=True)
        return f"{self.kind}-{hashlib.sha256(content.encode()).hexdigest()[:24]}"

    @property
    def task(self) -> Task:
        """The task that is flown.

        Raises:
            ScenarioError: the scenario does not exist any more.
            MaskError: the mask names no missile of it.
        """
        scenario = load_scenario(self.scenario)
        return Task(scenario, parse_mask(self.mask, scenario.launch.missiles))

    @property
    def weight(self) -> float:
        """How long it takes beside other work."""
        if self.kind != "evaluation":
            return BRIEF_WEIGHT
        return (NETWORK_WEIGHT if self.policy_digest else RULE_WEIGHT) * self.episodes / 1000.0

    def to_json(self) -> dict[str, Any]:
        """All fields as plain JSON values."""
        return dataclasses.asdict(self) | {"numbers": list(self.numbers)}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Work:
        """The work that `to_json` wrote."""
        return cls(**{**values, "numbers": tuple(values["numbers"])})


def source() -> str:
    """Identifies the simulator and what flies in it: after any change everything is flown again."""
    from workbench.reproduce.provenance import source_digest

    return source_digest()


def mask_text(task: Task) -> str:
    """The task's mask as in `--mask`."""
    return ",".join(str(missile) for missile in sorted(task.masked))
