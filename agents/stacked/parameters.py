"""Parameters of many networks of one shape: a flat row per network, with views of it as layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import torch
from torch import Tensor
from torch.optim.adam import adam

from agents.layers import Shape, layers_of

BETAS = (0.9, 0.999)
EPSILON = 1e-8


class Group:
    """Networks of S agents, `twins` each, with gradients and Adam's moments; every tensor leads with the agents."""

    def __init__(self, agents: int, twins: int, shape: Shape, device: torch.device, dtype: torch.dtype) -> None:
        """Zeros everywhere; a network without weights computes nothing until an agent moves in."""
        self.shape, self.twins = shape, twins
        full = (agents, twins, shape.size)
        self.values, self.gradient, self.mean, self.square = (
            torch.zeros(full, device=device, dtype=dtype) for _ in range(4)
        )
        self.steps = torch.zeros((agents, twins), device=device)
        self.layers = layers_of(self.values.view(-1, shape.size), shape)
        self.slopes = layers_of(self.gradient.view(-1, shape.size), shape)
        self._rows = [list(part.view(-1, shape.size).unbind()) for part in self.tensors[:4]]
        self._counts = list(self.steps.view(-1).unbind())

    @property
    def tensors(self) -> list[Tensor]:
        """Everything that changes, agents first."""
        return [self.values, self.gradient, self.mean, self.square, self.steps]

    def step(self, learning_rate: float) -> None:
        """One step of Adam: every network with its own moments and its own count of steps."""
        values, slopes, means, squares = self._rows
        adam(
            values, slopes, means, squares, [], self._counts, fused=True, amsgrad=False, beta1=BETAS[0], beta2=BETAS[1],
            lr=learning_rate, weight_decay=0.0, eps=EPSILON, maximize=False,
        )  # fmt: skip


@contextmanager
def put_back(agents: Sequence[int], tensors: Sequence[Tensor]) -> Iterator[None]:
    """Whatever happens to these agents' rows of the tensors within the block has not happened, to the last bit.

    Agents wait only for a few steps, when a stage begins. A mask in every operation would cost all steps instead.
    """
    rows = list(agents)
    kept = [tensor[rows].clone() for tensor in tensors] if rows else []
    yield
    for tensor, before in zip(tensors if rows else (), kept, strict=True):
        tensor[rows] = before
