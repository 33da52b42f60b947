"""The plan: which trainings and which evaluations an item of the paper needs; nothing is run here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from agents.config import VARIANTS, TrainingConfig
from workbench.reproduce.protocol import (
    BASELINES,
    CURRICULUM_VARIANTS,
    EPISODES,
    LABELS,
    REPORT_SEED,
    SCENARIO,
    SELECTION_SEED,
    TASK_LABELS,
    TRAINED_FOR,
    Item,
    Purpose,
)
from workbench.reproduce.seed_counts import SeedCounts

MISSILES = 4
"""Missiles of the paper's target task."""
CHAIN = tuple(TASK_LABELS)
"""The tasks of Table 1, the one without missiles first."""


@dataclass(frozen=True)
class Wanted:
    """One evaluation: a policy on a task, on episodes that it has never met."""

    variant: str
    """Key of LABELS."""
    task: str
    """Name of the task, one of CHAIN."""
    purpose: Purpose
    """Whether the figures are reported, or only choose among seeds."""
    seed: int | None = None
    """Seed of the training whose policy flies; None for a policy that comes with the workbench."""
    policy: str = ""
    """POLICY that flies where none is trained."""

    @property
    def mask(self) -> tuple[int, ...]:
        """Missiles masked in the task: the highest (Table 1)."""
        return tuple(range(CHAIN.index(self.task) + 1, MISSILES + 1))

    @property
    def evaluation_seed(self) -> int:
        """Seed of the initial states."""
        return REPORT_SEED if self.purpose == "report" else SELECTION_SEED


@dataclass(frozen=True)
class Plan:
    """What one item needs."""

    item: Item
    profile: str
    seeds: SeedCounts
    episodes: int
    trainings: tuple[TrainingConfig, ...]
    """Seed by seed, so that after a while there is something of every algorithm."""
    wanted: tuple[Wanted, ...]
    left_out: tuple[str, ...] = ()
    """Sentences about what the paper has and this version cannot run."""

    @property
    def command(self) -> str:
        """Command line that carries this plan out."""
        words = [f"workbench reproduce {self.item}"]
        words += [f"--profile {self.profile} {self.seeds.options}"] if self.trainings else []
        words += [f"--episodes {self.episodes}"] if self.episodes != EPISODES else []
        return " ".join(words)


def make_plan(item: Item, profile: str, seeds: SeedCounts, episodes: int) -> Plan:
    """Trainings and evaluations of one item; `seeds` says how many trainings of which algorithm.

    Raises:
        ConfigError: the profile is unknown, or a seed is out of range.
    """
    known = [variant for variant in TRAINED_FOR[item] if variant in VARIANTS]
    left_out = [
        f"{LABELS[variant]} is not run: this version cannot train it"
        for variant in TRAINED_FOR[item]
        if variant not in VARIANTS
    ]
    pairs = list(_pairs(known, seeds))
    trainings = tuple(training_of(variant, profile, seed) for variant, seed in pairs)
    return Plan(item, profile, seeds, episodes, trainings, tuple(_wanted(item, pairs)), tuple(left_out))


def training_of(variant: str, profile: str, seed: int) -> TrainingConfig:
    """The training behind one algorithm and seed: the whole chain, or the target task from scratch."""
    curriculum = variant in CURRICULUM_VARIANTS
    values = {"scenario": SCENARIO, "missiles": MISSILES, "variant": variant, "profile": profile, "seed": seed}
    return TrainingConfig.from_json({**values, "curriculum": curriculum})


def _pairs(variants: Sequence[str], seeds: SeedCounts) -> Iterator[tuple[str, int]]:
    """Algorithm and seed, seed by seed."""
    for seed in range(max((seeds.of(variant) for variant in variants), default=0)):
        yield from ((variant, seed) for variant in variants if seed < seeds.of(variant))


def _wanted(item: Item, pairs: Sequence[tuple[str, int]]) -> Iterator[Wanted]:
    if item == "fig13":
        yield from _both_policies()
    for variant, seed in pairs:
        # Fig. 8 has a panel for each task that is trained; a baseline knows the target task alone.
        tasks = CHAIN[1:] if item == "fig8" and variant not in BASELINES else CHAIN[-1:]
        for task in tasks:
            yield Wanted(variant, task, "report", seed)
        if item == "table4":
            yield Wanted(variant, "target", "selection", seed)


def _both_policies() -> Iterator[Wanted]:
    """Five tasks, two policies (Fig. 13); besides, the target task's policy on all five."""
    for task in CHAIN:
        # Source task 4 has no missile: its SubMas-RL policy is the navigation expert (§4.1).
        trained = "expert-navigation" if task == "source-4" else f"submas-{task}"
        yield Wanted("submas", task, "report", policy=trained)
        yield Wanted("expert", task, "report", policy="expert-dragging")
        yield Wanted("submas-target", task, "report", policy="submas-target")
