"""What configures a training: one frozen record, with the variants of Table 3."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, Literal, get_args

from agents.hyperparameters import PROFILES, ConfigError, Hyperparameters
from sim.scenario_file import load_scenario

__all__ = ["PROFILES", "VARIANTS", "ConfigError", "Hyperparameters", "TrainingConfig", "Variant"]


Schedule = Literal["adaptive", "decayed"]


@dataclass(frozen=True)
class Variant:
    """One row of Table 3: which of policy distillation and policy reuse act, and how their weights move."""

    distillation: bool = True
    """Policy distillation (Eq. 14-15)."""
    reuse: bool = True
    """Policy reuse (Eq. 17-18)."""
    alpha: Schedule = "adaptive"
    """Schedule of α: Eq. 16 and 20, or a linear decay."""
    epsilon: Schedule = "adaptive"
    """Schedule of ε: Eq. 19 and 21, or a linear decay."""


VARIANTS: Final[Mapping[str, Variant]] = MappingProxyType(
    {
        "submas": Variant(),
        "wo-pd": Variant(distillation=False),
        "wo-pr": Variant(reuse=False),
        "dec-pd": Variant(alpha="decayed"),
        "dec-pr": Variant(epsilon="decayed"),
        # Not an ablation but the baseline of §4.3: the same learner without any guide.
        "td3": Variant(distillation=False, reuse=False),
    }
)
"""Ablations of Table 3 and the TD3 baseline, by name."""

ProfileName = Literal["paper", "fast", "smoke"]
VariantName = Literal["submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr", "td3"]
EVERY_MISSILE: Final = -1
"""Number of missiles that stands for all of the scenario's; a configuration turns it into their number."""
_CHOICES: Final = {"profile": get_args(ProfileName), "variant": get_args(VariantName)}
_RANGES: Final = {"missiles": (1, 64), "seed": (0, 2**31 - 1)}
_TYPES: Final = {"str": str, "bool": bool, "int": int, "ProfileName": str, "VariantName": str}


@dataclass(frozen=True)
class TrainingConfig:
    """One training, as the command line, the pages and `config.json` write it."""

    scenario: str = "default"
    """Scenario by name, or the path of a scenario file."""
    curriculum: bool = False
    """Train the whole chain of source tasks (Algorithm 5) instead of one stage (Algorithm 4)."""
    missiles: int = EVERY_MISSILE
    """Train the task with missiles 1 … N, all of the scenario's by default; with a curriculum it is the target."""
    guide: str = ""
    """Policy that guides the (first) stage; empty takes that of the next easier task."""
    variant: VariantName = "submas"
    """Ablation of Table 3, or `td3` for the same learner without a guide."""
    profile: ProfileName = "fast"
    """Hyperparameters: `paper` is Table 2, `fast` takes minutes, `smoke` seconds."""
    seed: int = 0
    """Seed of networks, exploration and initial states."""
    name: str = ""
    """Free text to recognise the run by."""

    def __post_init__(self) -> None:
        """Count the missiles if that was left open; reject unknown profiles and variants and numbers out of range.

        Raises:
            ConfigError: naming the field, its value and what is legal.
            ScenarioError: the missiles are to be counted and there is no such scenario.
        """
        _check_field("scenario", self.scenario, str)
        if not self.scenario.strip():
            raise ConfigError("scenario is empty; give the name of a scenario, for example 'default'")
        if self.missiles == EVERY_MISSILE:
            object.__setattr__(self, "missiles", load_scenario(self.scenario).launch.missiles)
        for item in dataclasses.fields(self):
            _check_field(item.name, getattr(self, item.name), _TYPES[str(item.type)])
        if len(self.name) > 200 or not self.name.isprintable():
            raise ConfigError("name must be one printable line of at most 200 characters")

    @property
    def hyperparameters(self) -> Hyperparameters:
        """Numbers of the chosen profile."""
        return PROFILES[self.profile]

    def to_json(self) -> dict[str, Any]:
        """All fields as plain JSON values."""
        return dataclasses.asdict(self)

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> TrainingConfig:
        """Inverse of `to_json`; missing keys take their defaults.

        Raises:
            ConfigError: an unknown key, a wrong type or a value out of range.
        """
        if not isinstance(values, Mapping):
            raise ConfigError(f"a training configuration is a JSON object, not {type(values).__name__}")
        known = [item.name for item in dataclasses.fields(cls)]
        unknown = sorted(set(values) - set(known))
        if unknown:
            raise ConfigError(f"unknown key '{unknown[0]}' in a training configuration; known are {', '.join(known)}")
        return cls(**values)


def _check_field(name: str, value: Any, kind: type) -> None:
    # bool is a subclass of int in Python; `"missiles": true` is still a mistake.
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ConfigError(f"{name} is {value!r}; a {kind.__name__} is needed")
    if name in _CHOICES and value not in _CHOICES[name]:
        raise ConfigError(f"{name} '{value}' is unknown; choose {', '.join(_CHOICES[name])}")
    if name in _RANGES and not _RANGES[name][0] <= value <= _RANGES[name][1]:
        raise ConfigError(f"{name} is {value}; legal is {_RANGES[name][0]} to {_RANGES[name][1]}")
