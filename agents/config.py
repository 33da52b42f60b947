"""What configures a training: one frozen record, with the variants of Table 3."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, Literal, get_args

from agents.hyperparameters import PROFILES, ConfigError, Hyperparameters
from sim.errors import shorten
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
    mask: str = ""
    """Missiles of 1 … N that are masked besides, as in `1,3`; empty masks none."""
    order: str = ""
    """Algorithm 3's list of a curriculum's missiles, the most complex first, as in `4,1,2,3`; empty: highest first."""

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
        self._settle_task()

    def _settle_task(self) -> None:
        """Check mask and order, and write both so that the same training is always the same record."""
        masked = sorted(set(numbers_of("mask", self.mask)))
        wrong = [number for number in masked if not 1 <= number <= self.missiles]
        if wrong:
            raise ConfigError(f"mask names missile {wrong[0]}; legal are 1 to {self.missiles}")
        if len(masked) == self.missiles:
            raise ConfigError(f"mask '{self.mask}' masks every missile and leaves nothing to learn; leave one or more")
        # Missiles 1 and 2 of 4 are the stage `missiles=2`. A curriculum keeps its N: it is every missile of a scenario.
        while not self.curriculum and masked and masked[-1] == self.missiles:
            masked.pop()
            object.__setattr__(self, "missiles", self.missiles - 1)
        object.__setattr__(self, "mask", ",".join(map(str, masked)))
        order = numbers_of("order", self.order)
        if order:
            _check_order(self, order)
        usual = order == tuple(reversed(self.subtasks))
        object.__setattr__(self, "order", "" if usual else ",".join(map(str, order)))

    @property
    def subtasks(self) -> tuple[int, ...]:
        """Missiles of the task, ascending; with a curriculum those of its target."""
        masked = numbers_of("mask", self.mask)
        return tuple(number for number in range(1, self.missiles + 1) if number not in masked)

    @property
    def ordered_subtasks(self) -> tuple[int, ...]:
        """Subtasks τ₁ … τ_n as Algorithm 3 takes them: the most complex first, which is masked first and met last.

        Unless something else is asked for that is the last missile, as it adds to all others (Fig. 3).
        """
        return numbers_of("order", self.order) or tuple(reversed(self.subtasks))

    @property
    def stages(self) -> tuple[tuple[int, ...], ...]:
        """Missiles of the task of each stage, ascending, in the order in which stages are trained."""
        if not self.curriculum:
            return (self.subtasks,)
        met = tuple(reversed(self.ordered_subtasks))
        return tuple(tuple(sorted(met[:count])) for count in range(1, len(met) + 1))

    @property
    def hyperparameters(self) -> Hyperparameters:
        """Numbers of the chosen profile.

        Who learns from scratch gets as many epochs as the whole curriculum up to the task may take. Only `paper` leaves
        it the epochs of one stage, as in Fig. 9.
        """
        hyper = PROFILES[self.profile]
        if VARIANTS[self.variant].guided or self.curriculum or self.profile == "paper":
            return hyper
        return dataclasses.replace(hyper, epochs=len(self.subtasks) * hyper.epochs)

    def to_json(self) -> dict[str, Any]:
        """All fields as plain JSON values; mask and order only where there is one."""
        values = dataclasses.asdict(self)
        return {name: value for name, value in values.items() if value or name not in ("mask", "order")}

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


def numbers_of(name: str, text: str) -> tuple[int, ...]:
    """Numbers of a list such as `4,1,2`, in their order; none of an empty text.

    Raises:
        ConfigError: something else than whole numbers between commas, with the field's `name` and the text.
    """
    parts = [part.strip() for part in text.split(",")]
    if parts == [""]:
        return ()
    if len(text) > 400 or not all(part.isascii() and part.isdigit() for part in parts):
        raise ConfigError(f"{name} {text[:60]!r} is not a list of missiles; write numbers between commas, as in 1,2")
    return tuple(map(int, parts))


def _check_order(config: TrainingConfig, order: tuple[int, ...]) -> None:
    """Raise `ConfigError` unless a curriculum is ordered, and by each of its missiles once."""
    if not config.curriculum:
        raise ConfigError(f"order is '{config.order}', and a single stage has none; order a curriculum (--curriculum)")
    if tuple(sorted(order)) != config.subtasks:
        wanted = ",".join(map(str, config.subtasks))
        raise ConfigError(f"order '{config.order[:60]}' must name each of the missiles {wanted} once")


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
        raise ConfigError(f"{name} is {shorten(repr(value))}; a {kind.__name__} is needed")
    if name in _CHOICES and value not in _CHOICES[name]:
        raise ConfigError(f"{name} '{shorten(value)}' is unknown; choose {', '.join(_CHOICES[name])}")
    if name in _RANGES and not _RANGES[name][0] <= value <= _RANGES[name][1]:
        raise ConfigError(f"{name} is {shorten(repr(value))}; legal is {_RANGES[name][0]} to {_RANGES[name][1]}")
