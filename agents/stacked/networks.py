"""Actors and critics of all agents at once: batched matrix products and gradients written by hand.

The same arithmetic as `agents.td3_fast`, with an axis of agents in front: N networks, K rows each.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from agents.stacked.parameters import Layer

# Operators that autograd calls as well; the stubs do not list them.
_aten: Any = torch.ops.aten
NORM_EPSILON = 1e-5


@dataclass(frozen=True)
class Saved:
    """What a backward pass needs from its forward pass, one entry per hidden layer."""

    inputs: list[Tensor]
    """Input of every layer, the last one included `[N, K, in]`."""
    linear: list[Tensor]
    """Input of every normalisation `[N, K, out]`."""
    normed: list[tuple[Tensor, Tensor, Tensor]]
    """Its output before scale and shift `[N, K, out]`, mean and inverse deviation `[N, K, 1]`; empty without one."""


def forward(layers: list[Layer], inputs: Tensor) -> tuple[Tensor, Saved]:
    """Outputs `[N, K, out]` of inputs `[N, K, in]`, without a bend at the end, and what `backward` needs."""
    saved = Saved([inputs], [], [])
    for layer in layers[:-1]:
        linear = torch.baddbmm(layer.bias, saved.inputs[-1], layer.weight)
        saved.linear.append(linear)
        if layer.scale is None or layer.shift is None:
            saved.inputs.append(torch.relu(linear))
            continue
        parts = torch.native_layer_norm(linear, linear.shape[-1:], None, None, NORM_EPSILON)
        saved.normed.append(parts)
        saved.inputs.append(torch.addcmul(layer.shift, parts[0], layer.scale).relu_())
    return torch.baddbmm(layers[-1].bias, saved.inputs[-1], layers[-1].weight), saved


def actions(layers: list[Layer], features: Tensor) -> Tensor:
    """Actions `[N, K, 1]` in [-1, 1] of features `[N, K, f]`."""
    return forward(layers, features)[0].tanh_()


def backward(layers: list[Layer], slopes: list[Layer], saved: Saved, gradient: Tensor) -> None:
    """Write the gradients of all parameters for the outputs' `gradient` `[N, K, out]`."""
    for index in reversed(range(len(layers))):
        torch.bmm(saved.inputs[index].transpose(1, 2), gradient, out=slopes[index].weight)
        torch.sum(gradient, 1, keepdim=True, out=slopes[index].bias)
        if index:
            gradient = torch.bmm(gradient, layers[index].weight.transpose(1, 2))
            gradient = _through_bend(layers[index - 1], slopes[index - 1], saved, index - 1, gradient)


def action_slope(layers: list[Layer], saved: Saved, gradient: Tensor) -> Tensor:
    """Slope towards the action `[N, K, 1]`, the last input, for the outputs' `gradient` `[N, K, out]`."""
    for index in reversed(range(1, len(layers))):
        gradient = torch.bmm(gradient, layers[index].weight.transpose(1, 2))
        gradient = _through_bend(layers[index - 1], None, saved, index - 1, gradient)
    return torch.bmm(gradient, layers[0].weight[:, -1:].transpose(1, 2))


def _through_bend(layer: Layer, slope: Layer | None, saved: Saved, index: int, gradient: Tensor) -> Tensor:
    """Gradient before a hidden layer's activation and normalisation; stores those of the latter where wanted."""
    gradient = _aten.threshold_backward(gradient, saved.inputs[index + 1], 0)
    if layer.scale is None:
        return gradient
    normed, mean, inverse = saved.normed[index]
    if slope is not None:
        assert slope.scale is not None and slope.shift is not None
        torch.sum(gradient * normed, 1, keepdim=True, out=slope.scale)
        torch.sum(gradient, 1, keepdim=True, out=slope.shift)
    shape, wanted = normed.shape[-1:], [True, False, False]
    return _aten.native_layer_norm_backward(
        gradient * layer.scale, saved.linear[index], shape, mean, inverse, None, None, wanted
    )[0]
