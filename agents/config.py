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
Algorithm = Literal["td3", "sac", "ppo"]


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
    algorithm: Algorithm = "td3"
    """What learns: the TD3 of Algorithm 4, or Stable-Baselines3's SAC or PPO (§4.3)."""

    @property
    def guided(self) -> bool:
        """Whether a guide takes part in learning."""
        return self.distillation or self.reuse

    @property
    def from_library(self) -> bool:
        """Whether Stable-Baselines3 learns, which knows neither guide nor curriculum."""
        return self.algorithm != "td3"


VARIANTS: Final[Mapping[str, Variant]] = MappingProxyType(
    {
        "submas": Variant(),
        "wo-pd": Variant(distillation=False),
        "wo-pr": Variant(reuse=False),
        "dec-pd": Variant(alpha="decayed"),
        "dec-pr": Variant(epsilon="decayed"),
        # Not ablations but the baselines of §4.3: the same learner without any guide, and two others.
        "td3": Variant(distillation=False, reuse=False),
        "sac": Variant(distillation=False, reuse=False, algorithm="sac"),
        "ppo": Variant(distillation=False, reuse=False, algorithm="ppo"),
    }
)
"""Ablations of Table 3 and the baselines of §4.3 (Fig. 9), by name."""

ProfileName = Literal["paper", "fast", "smoke"]
VariantName = Literal["submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr", "td3", "sac", "ppo"]
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
    """Ablation of Table 3, or a baseline that learns from scratch: `td3` (the same learner), `sac` or `ppo`."""
    profile: ProfileName = "fast"
    """Hyperparameters: `paper` is Table 2, `fast` takes minutes, `smoke` seconds."""
    seed: int = 0
    """Seed of networks, exploration and initial states."""
    name: str = ""
    """Free text to recognise the run by."""

    def __post_init__(self) -> None:
        """Count the missiles if that was left open; reject unknown profiles and variants and numbers out of range.

        Raises:
            ConfigError: naming the field, its value and what is legal; or a curriculum or a guide for SAC or PPO.
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
        if VARIANTS[self.variant].from_library:
            _check_single(self)

    @property
    def hyperparameters(self) -> Hyperparameters:
        """Numbers of the chosen profile.

        Who learns from scratch gets as many epochs as the whole curriculum up to the task may take. Only `paper` leaves
        it the epochs of one stage, as in Fig. 9.
        """
        hyper = PROFILES[self.profile]
        if VARIANTS[self.variant].guided or self.curriculum or self.profile == "paper":
            return hyper
        return dataclasses.replace(hyper, epochs=self.missiles * hyper.epochs)

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


def _check_single(config: TrainingConfig) -> None:
    """Raise `ConfigError` if SAC or PPO is to follow a curriculum or a guide."""
    if config.curriculum:
        raise ConfigError(
            f"variant '{config.variant}' learns its task from scratch and has no curriculum; "
            "train a single stage (without --curriculum)"
        )
    if config.guide:
        raise ConfigError(
            f"variant '{config.variant}' learns without a guide, and guide is {config.guide[:60]!r}; choose none"
        )


def _check_field(name: str, value: Any, kind: type) -> None:
    # bool is a subclass of int in Python; `"missiles": true` is still a mistake.
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise ConfigError(f"{name} is {value!r}; a {kind.__name__} is needed")
    if name in _CHOICES and value not in _CHOICES[name]:
        raise ConfigError(f"{name} '{value}' is unknown; choose {', '.join(_CHOICES[name])}")
    if name in _RANGES and not _RANGES[name][0] <= value <= _RANGES[name][1]:
        raise ConfigError(f"{name} is {value}; legal is {_RANGES[name][0]} to {_RANGES[name][1]}")
