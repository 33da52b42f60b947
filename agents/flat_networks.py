"""Networks of one shape in flat tensors: their modules' parameters become views, one operation moves all of them."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn
from torch.optim.adam import adam

from agents.layers import Layer, Shape, layers_within


class FlatNetworks:
    """N networks of one shape, their gradients and how to step them; the modules see every change."""

    def __init__(self, modules: Sequence[nn.Module], shape: Shape) -> None:
        """Move the parameters of `modules` here: actors or critics of `agents.networks`, of this shape."""
        parameters = [parameter for module in modules for parameter in module.parameters()]
        self._shape, self._networks = shape, len(modules)
        self.values = nn.Parameter(parameters[0].new_empty(len(modules) * shape.size), requires_grad=False)
        self.gradient = torch.zeros_like(self.values)
        self.values.grad = self.gradient
        self.layers = layers_within(self.values.data, len(modules), shape)
        self.slopes = layers_within(self.gradient, len(modules), shape)
        for parameter, value, slope in zip(
            parameters, self._in_order(self.values.data), self._in_order(self.gradient), strict=True
        ):
            value.copy_(parameter.detach())
            parameter.requires_grad_(False)
            parameter.data, parameter.grad = value, slope

    def first(self) -> list[Layer]:
        """Layers of the first network alone `[1, …]`."""
        return [
            Layer(*(part[:1] for part in (layer.weight, layer.bias, layer.scale, layer.shift) if part is not None))
            for layer in self.layers
        ]

    def to_modules(self, flat: Tensor) -> Tensor:
        """Numbers that lie as the parameters do here, in the order of the modules' own parameters."""
        return torch.cat([part.flatten() for part in self._in_order(flat)])

    def from_modules(self, ordered: Tensor) -> Tensor:
        """The way back."""
        flat = torch.empty_like(ordered)
        parts = self._in_order(flat)
        for part, values in zip(parts, ordered.split([part.numel() for part in parts]), strict=True):
            part.copy_(values.view(part.shape))
        return flat

    def _in_order(self, flat: Tensor) -> list[Tensor]:
        """Views of a flat tensor in order and shape of the modules' parameters: weights `[out, in]`."""
        layers = layers_within(flat, self._networks, self._shape)
        return [part for network in range(self._networks) for part in _parameters_of(layers, network)]


def _parameters_of(layers: Sequence[Layer], network: int) -> list[Tensor]:
    """Views of one network as `agents.networks` orders its parameters: hidden layers, norms, last layer."""
    linear = [part for layer in layers for part in (layer.weight[network].t(), layer.bias[network, 0])]
    norms = [part[network, 0] for layer in layers for part in (layer.scale, layer.shift) if part is not None]
    return [*linear[:-2], *norms, *linear[-2:]]


def adam_step(optimizer: torch.optim.Adam) -> None:
    """One step of an optimiser of one flat parameter, without what `optimizer.step()` does besides.

    That takes as long as the arithmetic: a good twentieth of an update.
    """
    (group,) = optimizer.param_groups
    (flat,) = group["params"]
    state = optimizer.state[flat]
    if not state:  # the first step makes the moments
        optimizer.step()
        return
    beta1, beta2 = group["betas"]
    adam(
        [flat], [flat.grad], [state["exp_avg"]], [state["exp_avg_sq"]], [], [state["step"]], fused=True, amsgrad=False,
        beta1=beta1, beta2=beta2, lr=group["lr"], weight_decay=0.0, eps=group["eps"], maximize=False,
    )  # fmt: skip
