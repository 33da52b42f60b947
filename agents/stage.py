"""A stage of the curriculum: one task, the task its guide knows, and the rules by which it is trained."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from agents.config import TrainingConfig, Variant
from agents.hyperparameters import Hyperparameters
from agents.policy import Policy
from agents.task import Domain
from agents.transfer_mask import TransferMask


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
        """Seed of this stage: the same whether it is trained alone or within a curriculum."""
        return self.config.seed * 1_000 + len(self.domain.subtasks(self.task))

    @property
    def held_out_seed(self) -> int:
        """Seed of the initial states used for evaluation alone; never one of any training."""
        return 2**31 + self.seed

    @property
    def transfer_mask(self) -> TransferMask:
        """Where the guide's knowledge holds."""
        return TransferMask(self.task.layout, self.source.layout, self.domain.default_block)
