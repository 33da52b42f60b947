"""Parameters of many networks of one shape: a flat row per network, with views of it as layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise

import torch
from torch import Tensor
from torch.optim.adam import adam

BETAS = (0.9, 0.999)
EPSILON = 1e-8


@dataclass(frozen=True)
class Shape:
    """Widths of a network, inputs to outputs, and whether its hidden layers are normalised."""

    widths: tuple[int, ...]
    layer_norm: bool = False

    @property
    def parts(self) -> tuple[tuple[int, int], ...]:
        """Shapes of all parameters: weight `[in, out]`, bias `[1, out]`, and of a normalisation scale and shift."""
        found: list[tuple[int, int]] = []
        for index, (inputs, outputs) in enumerate(pairwise(self.widths)):
            normed = self.layer_norm and index < len(self.widths) - 2
            found += [(inputs, outputs), *[(1, outputs)] * (3 if normed else 1)]
        return tuple(found)

    @property
    def size(self) -> int:
        """Number of parameters of one network."""
        return sum(rows * columns for rows, columns in self.parts)


@dataclass(frozen=True)
class Layer:
    """One layer of N networks; views."""

    weight: Tensor
    """`[N, in, out]`"""
    bias: Tensor
    """`[N, 1, out]`"""
    scale: Tensor | None = None
    """Scale of the normalisation `[N, 1, out]`."""
    shift: Tensor | None = None
    """Its shift `[N, 1, out]`."""


def layers_of(flat: Tensor, shape: Shape) -> list[Layer]:
    """Views of rows `[N, P]` as layers, first to last."""
    views, start = [], 0
    for rows, columns in shape.parts:
        stop = start + rows * columns
        views.append(flat[:, start:stop].view(len(flat), rows, columns))
        start = stop
    layers, parts = [], iter(views)
    for index in range(len(shape.widths) - 1):
        normed = shape.layer_norm and index < len(shape.widths) - 2
        layers.append(Layer(*(next(parts) for _ in range(4 if normed else 2))))
    return layers


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
