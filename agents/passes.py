"""Forward and backward passes of N networks at once, K rows each: batched products, gradients written by hand.

The N are an agent's two critics (`agents.td3_fast`), or the networks of all agents (`agents.stacked`). Autograd is the
test oracle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from agents.layers import Layer

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
        linear = _products(layer, saved.inputs[-1])
        if layer.scale is None or layer.shift is None:
            saved.inputs.append(linear.relu_())
            continue
        saved.linear.append(linear)
        parts = _normalise(linear)
        saved.normed.append(parts)
        saved.inputs.append(torch.addcmul(layer.shift, parts[0], layer.scale).relu_())
    return _products(layers[-1], saved.inputs[-1]), saved


def actions(layers: list[Layer], features: Tensor) -> Tensor:
    """Actions `[N, K, 1]` in [-1, 1] of features `[N, K, f]`."""
    return forward(layers, features)[0].tanh_()


def backward(layers: list[Layer], slopes: list[Layer], saved: Saved, gradient: Tensor) -> None:
    """Write the gradients of all parameters for the outputs' `gradient` `[N, K, out]`."""
    for index in reversed(range(len(layers))):
        _store(slopes[index], saved.inputs[index], gradient)
        if index:
            gradient = _back(layers[index].weight, gradient)
            gradient = _through_bend(layers[index - 1], slopes[index - 1], saved, index - 1, gradient)


def action_slope(layers: list[Layer], saved: Saved, gradient: Tensor) -> Tensor:
    """Slope towards the action `[N, K, 1]`, the last input, for the outputs' `gradient` `[N, K, out]`."""
    for index in reversed(range(1, len(layers))):
        gradient = _back(layers[index].weight, gradient)
        gradient = _through_bend(layers[index - 1], None, saved, index - 1, gradient)
    return torch.linalg.vecdot(gradient, layers[0].weight[:, -1:])[..., None]


# A matrix of one column is a vector: as sums of products it takes a half or a third of the time of a matrix product.


def _products(layer: Layer, inputs: Tensor) -> Tensor:
    """What a layer makes of its inputs `[N, K, in]`, before any bend `[N, K, out]`."""
    if layer.weight.shape[2] > 1:
        return torch.baddbmm(layer.bias, inputs, layer.weight)
    return torch.linalg.vecdot(inputs, layer.weight.mT)[..., None].add_(layer.bias)


def _normalise(linear: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Layer normalisation without scale and shift: the result, mean and inverse deviation `[N, K, 1]`.

    torch's own takes more than twice as long when it is given no scale.
    """
    mean = linear.mean(2, keepdim=True)
    centred = linear - mean
    deviation = torch.linalg.vector_norm(centred, dim=2, keepdim=True)
    inverse = (deviation.square_().div_(linear.shape[2])).add_(NORM_EPSILON).rsqrt_()
    return centred.mul_(inverse), mean, inverse


def _back(weight: Tensor, gradient: Tensor) -> Tensor:
    """Gradient of a layer's inputs `[N, K, in]` from that of its outputs `[N, K, out]`."""
    return torch.bmm(gradient, weight.mT) if weight.shape[2] > 1 else gradient * weight.mT


def _store(slope: Layer, inputs: Tensor, gradient: Tensor) -> None:
    """Write the gradients of a layer's weight and bias."""
    if slope.weight.shape[2] > 1:
        torch.bmm(inputs.mT, gradient, out=slope.weight)
    else:
        torch.sum(inputs * gradient, 1, keepdim=True, out=slope.weight.mT)
    torch.sum(gradient, 1, keepdim=True, out=slope.bias)


def _through_bend(layer: Layer, slope: Layer | None, saved: Saved, index: int, gradient: Tensor) -> Tensor:
    """Gradient before a hidden layer's activation and normalisation; stores those of the latter where wanted."""
    # In place: nobody else holds what `_back` has made.
    _aten.threshold_backward(gradient, saved.inputs[index + 1], 0, grad_input=gradient)
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
