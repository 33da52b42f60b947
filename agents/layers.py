"""Layers of N networks of one shape, as views of flat tensors: how `agents.passes` wants parameters and gradients."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from torch import Tensor

from agents.hyperparameters import Hyperparameters


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
            found += [(inputs, outputs), *[(1, outputs)] * (3 if self._normed(index) else 1)]
        return tuple(found)

    @property
    def size(self) -> int:
        """Number of parameters of one network."""
        return sum(rows * columns for rows, columns in self.parts)

    def layers(self, views: Iterator[Tensor]) -> list[Layer]:
        """Views of all parts, in order, as layers, first to last."""
        return [
            Layer(*(next(views) for _ in range(4 if self._normed(index) else 2)))
            for index in range(len(self.widths) - 1)
        ]

    def _normed(self, index: int) -> bool:
        return self.layer_norm and index < len(self.widths) - 2


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


def shapes_of(features: int, hyper: Hyperparameters) -> tuple[Shape, Shape]:
    """Actor and critic of `agents.networks`, for so many features."""
    outputs = 2 if hyper.two_returns else 1
    return Shape((features, *hyper.hidden, 1)), Shape((features + 1, *hyper.hidden, outputs), hyper.layer_norm)


def layers_of(rows: Tensor, shape: Shape) -> list[Layer]:
    """Views of `[N, P]`, a row per network, as layers: whole networks can be copied, put back or moved."""
    return shape.layers(_views_of_rows(rows, shape))


def layers_within(flat: Tensor, networks: int, shape: Shape) -> list[Layer]:
    """Views of `[N · P]`, part after part, each for all N networks: every part is contiguous.

    For a processor, where the transpose of weights that lie apart would be copied for every product.
    """
    return shape.layers(_views_of_parts(flat, networks, shape))


def _views_of_rows(rows: Tensor, shape: Shape) -> Iterator[Tensor]:
    start = 0
    for height, width in shape.parts:
        yield rows[:, start : start + height * width].view(len(rows), height, width)
        start += height * width


def _views_of_parts(flat: Tensor, networks: int, shape: Shape) -> Iterator[Tensor]:
    start = 0
    for height, width in shape.parts:
        stop = start + networks * height * width
        yield flat[start:stop].view(networks, height, width)
        start = stop
