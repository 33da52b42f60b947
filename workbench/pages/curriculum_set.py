"""What one launch trains: a run for every variant and seed, each with a chain or a single stage to learn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from agents.config import VARIANTS as CONFIGURED
from agents.config import TrainingConfig
from sim.errors import UsageError
from sim.task import Task

STAGE, CHAIN = "This task alone", "Chain up to this task"
MOST_RUNS = 100
"""Runs that one launch may queue."""


@dataclass(frozen=True)
class TrainingSet:
    """The choices of the launch form, all of them legal one by one."""

    task: Task
    """The task that is trained alone, or the target of the chain."""
    scenario: str
    """Its scenario, by name or path."""
    chain: bool
    met: tuple[int, ...]
    """Missiles of the task in the order they are met along the chain."""
    variants: tuple[str, ...]
    seeds: tuple[int, ...]
    profile: str
    guide: str
    name: str

    def configurations(self) -> list[TrainingConfig]:
        """One per variant and seed; every variant's first seed comes before any second one.

        Raises:
            UsageError: nothing to learn, no variant, or more runs than one launch may queue.
        """
        if not self.task.missiles:
            raise UsageError(
                "with every missile masked the navigation expert already solves the task; unmask a missile"
            )
        if not self.variants:
            raise UsageError("no variant is chosen; choose one or more")
        count = len(self.variants) * len(self.seeds)
        if count > MOST_RUNS:
            raise UsageError(
                f"{len(self.variants)} variants × {len(self.seeds)} seeds are {count} runs; "
                f"at most {MOST_RUNS} can be launched at once"
            )
        return [self._configuration(variant, seed) for seed in self.seeds for variant in self.variants]

    def _configuration(self, variant: str, seed: int) -> TrainingConfig:
        # Who learns from scratch learns the task itself: there is no guide to be handed along a chain.
        chain = self.chain and CONFIGURED[variant].guided
        return TrainingConfig.from_json(
            {
                "scenario": self.scenario,
                "curriculum": chain,
                "missiles": self.task.scenario.launch.missiles,
                "mask": listed(sorted(self.task.masked)),
                "order": listed(self.met[::-1]) if chain else "",
                "guide": self.guide if CONFIGURED[variant].guided else "",
                "variant": variant,
                "profile": self.profile,
                "name": self.name,
                "seed": seed,
            }
        )


def listed(numbers: Sequence[int]) -> str:
    """Numbers as the command line writes them: `4,3,2,1`."""
    return ",".join(map(str, numbers))
