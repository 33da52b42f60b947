"""A result set: every number, curve and flight behind one item of the paper.

Pages, pictures and documents draw from result sets alone; none of them computes a number of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from workbench.reproduce.protocol import Item, Purpose

SCHEMA: Final = 1
"""Version of the file's form; a file of another version is not read."""


@dataclass(frozen=True, kw_only=True)
class Number:
    """Figures of one policy on one task, and where they come from."""

    variant: str
    """Key of `protocol.LABELS`."""
    task: str
    seed: int | None
    """Seed of the training; None for a policy that comes with the workbench."""
    purpose: Purpose
    """Reported, or flown only to choose among seeds."""
    success_rate: float
    success_ci95: tuple[float, float]
    """Wilson 95 % interval."""
    mean_return: float
    mean_length_s: float
    outcomes: Mapping[str, int]
    """Episodes by the way they ended."""
    episodes: int
    evaluation_seed: int
    epochs: int | None
    """Epochs the stage was trained for; None where nothing was trained here."""
    env_steps: int | None
    """Environment steps of those epochs."""
    wall_s: float | None
    """Working time of the stage's training [s]."""
    scenario_digest: str
    command: str
    """Command line that gives these figures."""
    run: str = ""
    """Run that trained the policy; empty for one that comes with the workbench."""
    policy: str = ""
    """POLICY that flew where it comes with the workbench; else that of the run's stage."""
    policy_digest: str = ""
    """Identifies the policy file; empty for a rule."""


@dataclass(frozen=True, kw_only=True)
class Training:
    """One training and how it ended."""

    variant: str
    seed: int
    state: str
    """`finished`, `failed`, or how far it is."""
    run: str
    wall_s: float
    """Working time of all stages, as the clock has it [s]."""
    cpu_s: float
    """Processor time of all stages [s]: the time on one core of a machine with nothing else to do."""
    env_steps: int
    """Environment steps of all stages."""
    command: str
    """Command line that trains the same."""
    error: str = ""
    """Why it failed."""
    resumes: int = 0
    """How often it went on from a checkpoint, after a pause, a stop or a death."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Held-out evaluations of one stage while it was trained; arrays over T times."""

    variant: str
    task: str
    seed: int
    env_steps: tuple[int, ...]
    success_rate: tuple[float, ...]
    mean_return: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class MissileCurve:
    """Azimuth of one missile over the flight's times; None while it is not in flight."""

    number: int
    fate: str
    launch_s: float | None
    end_s: float | None
    azimuth_deg: tuple[float | None, ...]


@dataclass(frozen=True, kw_only=True)
class Flight:
    """Azimuth curves of one engagement (Fig. 12)."""

    variant: str
    policy: str
    seed: int
    episode: int
    outcome: str
    duration_s: float
    beam_share: float
    """Share of the time with a missile in flight in which the closest one is within 15° of ±90°."""
    time_s: tuple[float, ...]
    missiles: tuple[MissileCurve, ...]
    scenario_digest: str
    command: str
    policy_digest: str = ""


@dataclass(frozen=True, kw_only=True)
class ReplayMissile:
    """One missile seen from above; its points are those of consecutive times of the replay."""

    number: int
    fate: str
    end_s: float | None
    first: int
    """Index of its first point among the replay's times."""
    track_km: tuple[tuple[float, float], ...]


@dataclass(frozen=True, kw_only=True)
class Replay:
    """One engagement seen from above (Fig. 10, 11), over T times; the Fly page shows it in 3-D under its seed."""

    variant: str
    policy: str
    seed: int
    outcome: str
    duration_s: float
    moment_s: float
    """When most missiles fly and the closest is nearest: panel (a) of the paper's figures."""
    field_km: tuple[float, float]
    """Length and width of the battlefield."""
    exit_km: tuple[float, float]
    """Middle of the exit on the right edge, and half its width."""
    time_s: tuple[float, ...]
    evader_km: tuple[tuple[float, float], ...]
    interceptor_km: tuple[tuple[float, float], ...]
    missiles: tuple[ReplayMissile, ...]
    scenario_digest: str


@dataclass(frozen=True, kw_only=True)
class ResultSet:
    """The content of one file."""

    item: Item
    profile: str
    scenario: str
    scenario_digest: str
    episodes: int
    seeds: tuple[int, ...]
    """All seeds that were asked for; `trainings` says which of them are there."""
    command: str
    """Command line that makes this file."""
    code_version: str
    source_digest: str
    """Identifies the source of the simulator and of what flies: numbers of equal digest come from the same world."""
    left_out: tuple[str, ...] = ()
    trainings: tuple[Training, ...] = ()
    numbers: tuple[Number, ...] = ()
    curves: tuple[Curve, ...] = ()
    flights: tuple[Flight, ...] = ()
    replays: tuple[Replay, ...] = ()
    """Fig. 10 and 11, in the result set of Fig. 12."""
    seed_counts: Mapping[str, int] = field(default_factory=dict)
    """Trainings that were asked for by algorithm; one that is not named was asked for with all seeds."""
    schema: int = SCHEMA

    def asked_for(self, variant: str) -> int:
        """Trainings of one algorithm that were asked for."""
        return self.seed_counts.get(variant, len(self.seeds))

    def number(self, variant: str, task: str, seed: int | None, purpose: Purpose = "report") -> Number | None:
        """The number of one policy on one task, or None while it is not there."""
        wanted = (variant, task, seed, purpose)
        return next((n for n in self.numbers if (n.variant, n.task, n.seed, n.purpose) == wanted), None)

    def reported(self, variant: str, task: str) -> list[Number]:
        """Reported numbers of one algorithm on one task, by seed."""
        found = [n for n in self.numbers if (n.variant, n.task, n.purpose) == (variant, task, "report")]
        return sorted(found, key=lambda n: -1 if n.seed is None else n.seed)
