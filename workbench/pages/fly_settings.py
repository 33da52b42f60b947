"""What the Fly page shows, as its address says it: `?a=&b=&mask=&seed=&t=`."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from sim.errors import MaskError
from sim.task import parse_mask

SEED_MAX = 2**31 - 1
LONGEST = 60
"""Characters of a wrong value that are repeated to the person."""


FIRST_SEED = 2
"""Initial state a person sees first. It shows why to learn: the expert is shot down, the shipped policy exits."""


@dataclass(frozen=True)
class FlySettings:
    """Two policies, the masked missiles, the initial state and the clock."""

    a: str
    b: str
    masked: frozenset[int] = frozenset()
    seed: int = 0
    time_s: float = 0.0

    @property
    def mask(self) -> str:
        """The mask as in `--mask`."""
        return ",".join(str(number) for number in sorted(self.masked))

    def to_query(self) -> dict[str, str]:
        """Values of the address; reading them gives equal settings."""
        return {"a": self.a, "b": self.b, "mask": self.mask, "seed": str(self.seed), "t": f"{self.time_s:g}"}


def default_settings(policies: Sequence[str]) -> FlySettings:
    """The trained target policy beside the defensive-dragging expert, or navigation while no policy is shipped."""
    a = "submas-target" if "submas-target" in policies else "expert-navigation"
    return FlySettings(a, "expert-dragging", seed=FIRST_SEED)


def read_settings(
    query: Mapping[str, str], policies: Collection[str], defaults: FlySettings, missiles: int
) -> tuple[FlySettings, list[str]]:
    """Settings of an address, and one sentence for each value that was wrong and replaced by its default."""
    settings, problems = defaults, []
    for name in ("a", "b"):
        wanted = query.get(name, "")
        if wanted in policies:
            settings = replace(settings, **{name: wanted})
        elif wanted:
            instead = getattr(defaults, name)
            problems.append(f"Policy {_quoted(wanted)} is not known here, so {instead} flies as {name.upper()}.")
    try:
        settings = replace(settings, masked=parse_mask(query.get("mask", ""), missiles))
    except MaskError:
        problems.append(
            f"The mask {_quoted(query['mask'])} is not a list of missiles from 1 to {missiles}, so none is masked."
        )
    if (seed := query.get("seed", "")) and (known := _whole(seed)) is not None:
        settings = replace(settings, seed=known)
    elif seed:
        instead = f"so seed {defaults.seed} is flown."
        problems.append(f"Seed {_quoted(seed)} is not a whole number from 0 to {SEED_MAX}, {instead}")
    if (time := query.get("t", "")) and (seconds := _seconds(time)) is not None:
        settings = replace(settings, time_s=seconds)
    elif time:
        problems.append(f"Time {_quoted(time)} is not a number of seconds, so the clock starts at 0.")
    return settings, problems


def _quoted(value: str) -> str:
    return f"'{value}'" if len(value) <= LONGEST else f"'{value[:LONGEST]}…'"


def _whole(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 11 and int(text) <= SEED_MAX else None


def _seconds(text: str) -> float | None:
    try:
        seconds = float(text)
    except ValueError:
        return None
    return seconds if math.isfinite(seconds) and seconds >= 0.0 else None
