"""Lets a training by itself draw the very numbers that a stacked one counts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import torch

from agents.hyperparameters import Hyperparameters
from agents.stacked.draws import Purpose, normal, uniform


class Counted:
    """Stands in for both generators of one stage of a training by itself."""

    def __init__(self, seed: int, hyper: Hyperparameters) -> None:
        self.seeds, self.hyper = torch.tensor([seed]), hyper
        self.steps, self.updates = -1, 0
        self._uniform: list[np.ndarray] = []
        self._noise: list[torch.Tensor] = []

    def random(self, shape: int | tuple[int, ...]) -> np.ndarray:
        """For `draw_reuse` (twice a step, of lanes), then for `held_noise`."""
        if isinstance(shape, tuple):
            return self._at(uniform, Purpose.NOISE_END, shape[:1]).reshape(shape)
        if not self._uniform:
            self.steps += 1
            self._uniform = list(self._at(uniform, Purpose.SEGMENT, (2, shape)))
        return self._uniform.pop(0)

    def normal(self, mean: float, deviation: float, shape: tuple[int, ...]) -> np.ndarray:
        """Exploration noise."""
        return mean + deviation * self._at(normal, Purpose.NOISE, shape)

    def randint(self, high: int, shape: tuple[int], generator: object) -> torch.Tensor:
        """Which transitions a block of updates takes; the block's noise is drawn with them."""
        counts, count = torch.tensor([self.updates]), self.hyper.updates_per_lane_step
        self.updates += count
        batches = (count, self.hyper.batch_size, 1)
        self._noise = list(normal(self.seeds, Purpose.TARGET_NOISE, counts, batches)[0].float())
        return (uniform(self.seeds, Purpose.TRANSITIONS, counts, shape)[0] * high).long()

    def randn(self, shape: tuple[int, ...], generator: object) -> torch.Tensor:
        """Noise of the target policy in the next update."""
        return self._noise.pop(0).view(shape)

    def _at(self, draw: Callable[..., torch.Tensor], purpose: Purpose, shape: tuple[int, ...]) -> np.ndarray:
        return draw(self.seeds, purpose, torch.tensor([self.steps]), shape)[0].numpy()


def count_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    """From now on every stage that a training by itself begins draws by counting."""
    from agents import knowledge_transfer

    begin = knowledge_transfer.start_stage

    def start_stage(stage: Any) -> Any:
        state = begin(stage)
        counted: Any = Counted(stage.seed, stage.hyper)
        state.generator = counted
        monkeypatch.setattr(torch, "randint", counted.randint)
        monkeypatch.setattr(torch, "randn", counted.randn)
        return state

    monkeypatch.setattr(knowledge_transfer, "start_stage", start_stage)
