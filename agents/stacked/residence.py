"""How an agent gets its place in a stack, and what is read of it there: networks of one agent by themselves."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from agents.layers import Layer, layers_of
from agents.networks import Critic
from agents.stacked.learner import StackedTd3
from agents.task import FloatArray, IntArray
from agents.td3 import Td3

Weights = list[tuple[FloatArray, FloatArray]]
"""Weights `[out, in]` and biases `[out]`, first layer to last."""


@torch.no_grad()
def move_in(stack: StackedTd3, place: int, fresh: Td3, columns: IntArray) -> None:
    """Give a place to an agent whose networks are those of a fresh learner (Algorithm 4, line 1).

    Args:
        stack: where to.
        place: which place; whoever had it is gone, moments and counts with them.
        fresh: a learner of the agent's own sizes, not yet trained.
        columns: the stack's feature columns that are the agent's own, in its order.
    """
    for tensor in stack.tensors:
        tensor[place] = 0.0
    stack.updates[place] = 0
    _write_actor(stack.actor.layers, place, fresh.actor, columns)
    with_action = [*columns, stack.features]
    for twin, critic in enumerate((fresh.critics.first, fresh.critics.second)):
        _write_critic(stack.critics.layers, 2 * place + twin, critic, with_action)
    for target, online in (
        (stack.target_actor, stack.actor),
        (stack.average_actor, stack.actor),
        (stack.target_critics, stack.critics),
    ):
        target[place] = online.values[place]


@torch.no_grad()
def actor_weights(stack: StackedTd3, flat: Tensor, place: int, columns: IntArray) -> Weights:
    """One agent's actor, as it is or averaged (`flat` `[S, 1, P]`), on the agent's own columns; copies on the host."""
    layers = layers_of(flat[place].cpu(), stack.actor.shape)
    found: Weights = []
    for index, layer in enumerate(layers):
        weight = layer.weight[0][torch.as_tensor(columns)] if index == 0 else layer.weight[0]
        found.append((weight.t().contiguous().numpy().copy(), layer.bias[0, 0].numpy().copy()))
    return found


@torch.no_grad()
def write_weights(layers: list[Layer], place: int, weights: Weights, columns: Sequence[int] | IntArray) -> None:
    """Put one network into a stack's layers; its inputs lie in these columns."""
    for index, (layer, (weight, bias)) in enumerate(zip(layers, weights, strict=True)):
        put_linear(layer, place, torch.from_numpy(weight), torch.from_numpy(bias), columns if index == 0 else None)


def put_linear(
    layer: Layer, place: int, weight: Tensor, bias: Tensor, columns: Sequence[int] | IntArray | None
) -> None:
    """Put one weight `[out, in]` and bias `[out]` into a place; inputs that are not its own weigh nothing."""
    rows = layer.weight[place]
    rows.zero_()
    rows[slice(None) if columns is None else list(columns)] = weight.t().to(rows)
    layer.bias[place, 0] = bias.to(rows)


def _write_actor(layers: list[Layer], place: int, actor: nn.Module, columns: IntArray) -> None:
    linear = [module for module in actor.modules() if isinstance(module, nn.Linear)]
    for index, (layer, module) in enumerate(zip(layers, linear, strict=True)):
        put_linear(layer, place, module.weight, module.bias, columns if index == 0 else None)


def _write_critic(layers: list[Layer], place: int, critic: Critic, columns: Sequence[int]) -> None:
    linear = [module for module in critic.modules() if isinstance(module, nn.Linear)]
    for index, (layer, module) in enumerate(zip(layers, linear, strict=True)):
        put_linear(layer, place, module.weight, module.bias, columns if index == 0 else None)
    for layer, norm in zip(layers, critic.norms or (), strict=False):
        assert isinstance(norm, nn.LayerNorm) and layer.scale is not None and layer.shift is not None
        layer.scale[place, 0] = norm.weight.to(layer.scale)
        layer.shift[place, 0] = norm.bias.to(layer.shift)
