"""How the paper's numbers are measured here (§4): who is compared, on how many episodes, from which seeds."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, Literal

Item = Literal["table4", "fig8", "fig9", "fig12", "fig13"]
Purpose = Literal["report", "selection"]

ITEMS: Final[tuple[Item, ...]] = ("fig12", "fig13", "table4", "fig8", "fig9")
"""What can be reproduced, what needs no training first."""

SCENARIO: Final = "default"
EPISODES: Final = 1_000
"""Episodes behind every number, as in the paper (§4.3, §4.4)."""

SELECTION_SEED: Final = 2**45
"""Seed of the initial states on which the best of several seeds is chosen without bias."""
REPORT_SEED: Final = 2**46
"""Seed of the initial states behind every reported number: the same episodes for every policy.

Trainings draw from 2^42 on, their held-out evaluations from 2^43, their last judgement from 2^44 (`agents.stage`), each
within less than 2^42 numbers: no episode reported here was trained on, or took part in any choice.
"""

CURRICULUM_VARIANTS: Final = ("submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr")
"""Algorithms that learn along the whole chain of tasks (Table 3)."""
BASELINES: Final = ("td3", "ppo", "sac")
"""Algorithms that learn the target task from scratch (§4.3), in the order of Table 4."""
TRAINED_FOR: Final[Mapping[Item, tuple[str, ...]]] = MappingProxyType(
    {
        "table4": (*CURRICULUM_VARIANTS, *BASELINES),
        "fig8": CURRICULUM_VARIANTS,
        "fig9": ("submas", *BASELINES),
        "fig12": (),
        "fig13": (),
    }
)
"""Algorithms that an item needs trained."""

LABELS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "submas": "SubMas-RL",
        "wo-pd": "w/oPd",
        "wo-pr": "w/oPr",
        "dec-pd": "DecPd",
        "dec-pr": "DecPr",
        "td3": "TD3",
        "ppo": "PPO",
        "sac": "SAC",
        "expert": "expert policy",
        "submas-target": "SubMas-RL, target's policy",
    }
)
"""Algorithms and policies as the paper calls them."""
TASK_LABELS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "source-4": "source task 4",
        "source-3": "source task 3",
        "source-2": "source task 2",
        "source-1": "source task 1",
        "target": "target task",
    }
)
"""Tasks of the chain as the paper calls them, the easiest (no missile) first."""
