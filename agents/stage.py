"""A stage of the curriculum: one task, the task its guide knows, and the rules by which it is trained."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from agents.config import TrainingConfig, Variant
from agents.hyperparameters import Hyperparameters
from agents.policy import Policy
from agents.task import Domain
from agents.transfer_mask import TransferMask

TRAINING_SEEDS: Final = 2**42
HELD_OUT_SEEDS: Final = 2**43
FINAL_SEEDS: Final = 2**44


@dataclass(frozen=True, kw_only=True)
class Stage:
    """Input of Algorithm 4: the task 𝒯_k and its guide, plus everything that stays fixed during the stage."""

    task: Any
    """Task that is trained, a `SubtaskTask`."""
    source: Any
    """Task whose subtasks the guide knows; the transfer mask compares `task` with it."""
    guide: Policy
    """Guide policy μ_i."""
    domain: Domain
    """Where the tasks come from."""
    hyper: Hyperparameters
    """Numbers of the learner."""
    variant: Variant
    """Which parts of knowledge transfer act (Table 3)."""
    config: TrainingConfig
    """The training this stage is part of."""
    index: int = 0
    """Number of stages before this one."""
    count: int = 1
    """Number of stages of the training."""

    @property
    def seed(self) -> int:
        """Seed of this stage: the same whether it is trained alone or within a curriculum.

        Far above what a person types, so that `evaluate --seed 1` never meets an initial state of a training.
        """
        return TRAINING_SEEDS + self.config.seed * 1_000 + len(self.domain.subtasks(self.task))

    @property
    def held_out_seed(self) -> int:
        """Seed of the initial states used for evaluation alone; never one of any training."""
        return self.seed - TRAINING_SEEDS + HELD_OUT_SEEDS

    @property
    def final_seed(self) -> int:
        """Seed of the initial states that judge the stage's policy: neither trained on nor used to choose it."""
        return self.seed - TRAINING_SEEDS + FINAL_SEEDS

    @property
    def transfer_mask(self) -> TransferMask:
        """Where the guide's knowledge holds."""
        return TransferMask(self.task.layout, self.source.layout, self.domain.default_block)
