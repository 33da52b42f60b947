"""What the Fly page shows, as its address says it: `?a=&b=&scenario=&mask=&seed=&episode=&shot=&t=`."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from sim.errors import MaskError
from sim.scenario_file import load_scenario
from sim.task import parse_mask
from workbench.pages.fly_start import Shot, read_start
from workbench.scenarios import DEFAULT

SEED_MAX = 2**53 - 1
"""Largest whole number that a browser keeps exactly; the seeds of evaluations are large."""
TIME_MAX_S = 1e6
"""Latest time of the clock; no flight is nearly as long [s]."""
LONGEST = 60
"""Characters of a wrong value that are repeated to the person."""


FIRST_SEED = 2
"""Initial state a person sees first. It shows why to learn: the expert is shot down, the shipped policy exits."""


@dataclass(frozen=True)
class FlySettings:
    """Two policies, the masked missiles, the initial state, the clock and the scenario."""

    a: str
    b: str
    masked: frozenset[int] = frozenset()
    seed: int = 0
    time_s: float = 0.0
    scenario: str = DEFAULT
    episode: int = 0
    """Episode of the seed: an evaluation's episode k."""
    shot: Shot | None = None
    """One missile fired at once, instead of the whole engagement."""

    @property
    def mask(self) -> str:
        """The mask as in `--mask`."""
        return ",".join(str(number) for number in sorted(self.masked))

    def to_query(self) -> dict[str, str]:
        """Values of the address; reading them gives equal settings."""
        state = {"mask": self.mask, "seed": str(self.seed), "episode": str(self.episode), "t": f"{self.time_s:g}"}
        state["shot"] = self.shot.text if self.shot else ""
        return {"a": self.a, "b": self.b, "scenario": self.scenario, **state}


def default_settings(policies: Sequence[str]) -> FlySettings:
    """The trained target policy beside the defensive-dragging expert, or navigation while no policy is shipped."""
    a = "submas-target" if "submas-target" in policies else "expert-navigation"
    return FlySettings(a, "expert-dragging", seed=FIRST_SEED)


def read_settings(
    query: Mapping[str, str], policies: Collection[str], scenarios: Collection[str], defaults: FlySettings
) -> tuple[FlySettings, list[str]]:
    """Settings of an address, and one sentence for each value that was wrong and replaced by its default.

    Args:
        query: names and values of the address, which anybody may have written.
        policies: POLICY that may fly.
        scenarios: SCENARIO that may be flown in; nothing else is ever opened.
        defaults: what is taken where the address says nothing or something wrong.
    """
    scenario, problems = read_scenario(query, scenarios, defaults.scenario)
    settings, missiles = replace(defaults, scenario=scenario), load_scenario(scenario).launch.missiles
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
    start, wrong = read_start(query)
    settings = replace(settings, **start)
    problems += wrong
    if (time := query.get("t", "")) and (seconds := _seconds(time)) is not None:
        settings = replace(settings, time_s=seconds)
    elif time:
        problems.append(f"Time {_quoted(time)} is not a number of seconds, so the clock starts at 0.")
    return settings, problems


def keep_start(chosen: FlySettings, before: FlySettings) -> FlySettings:
    """What was chosen, with the episode or shot of the address as long as its seed is the same."""
    return replace(chosen, episode=before.episode, shot=before.shot) if chosen.seed == before.seed else chosen


def read_scenario(query: Mapping[str, str], scenarios: Collection[str], default: str) -> tuple[str, list[str]]:
    """SCENARIO of an address if it is one of those on offer, else the default and a sentence that says so."""
    wanted = query.get("scenario", "")
    if wanted in scenarios or not wanted:
        return wanted or default, []
    return default, [f"Scenario {_quoted(wanted)} is not known here, so {default} is taken."]


def _quoted(value: str) -> str:
    return f"'{value}'" if len(value) <= LONGEST else f"'{value[:LONGEST]}…'"


def _whole(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 17 and int(text) <= SEED_MAX else None


def _seconds(text: str) -> float | None:
    try:
        seconds = float(text)
    except ValueError:
        return None
    return seconds if 0.0 <= seconds <= TIME_MAX_S else None
