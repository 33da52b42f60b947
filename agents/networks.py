"""Actor and critics (Table 2: two hidden layers of 256, ReLU as in SpinningUp)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn

from agents.task import FloatArray


class Actor(nn.Module):
    """Deterministic policy μ_θ: features `[B, f]` -> actions `[B, 1]` as shares of the action limit, in [-1, 1]."""

    def __init__(self, features: int, hidden: Sequence[int]) -> None:
        super().__init__()
        widths = [features, *hidden, 1]
        self.layers = nn.ModuleList(nn.Linear(a, b) for a, b in pairwise(widths))

    def forward(self, features: Tensor) -> Tensor:
        """Actions `[B, 1]` in [-1, 1]."""
        *hidden, last = self.layers
        for layer in hidden:
            features = torch.relu(layer(features))
        return torch.tanh(last(features))

    def arrays(self) -> list[tuple[FloatArray, FloatArray]]:
        """Copies of all weights `[out, in]` and biases `[out]`, first layer to last."""
        linear = [layer for layer in self.layers if isinstance(layer, nn.Linear)]
        return [(layer.weight.detach().numpy().copy(), layer.bias.detach().numpy().copy()) for layer in linear]


class Critic(nn.Module):
    """Action value Q_φ: features `[B, f]` and actions `[B, 1]` -> `outputs` returns `[B, outputs]`."""

    def __init__(self, features: int, hidden: Sequence[int], outputs: int, layer_norm: bool) -> None:
        super().__init__()
        widths = [features + 1, *hidden]
        self.layers = nn.ModuleList(nn.Linear(a, b) for a, b in pairwise(widths))
        self.norms = nn.ModuleList(nn.LayerNorm(width) for width in hidden) if layer_norm else None
        self.head = nn.Linear(hidden[-1], outputs)

    def forward(self, features: Tensor, action: Tensor) -> Tensor:
        """Returns `[B, outputs]` of taking the action and following the policy."""
        hidden = torch.cat((features, action), dim=1)
        for index, layer in enumerate(self.layers):
            hidden = layer(hidden)
            if self.norms is not None:
                hidden = self.norms[index](hidden)
            hidden = torch.relu(hidden)
        return self.head(hidden)


class TwinCritic(nn.Module):
    """The two critics of clipped double Q-learning, independent of each other."""

    def __init__(self, features: int, hidden: Sequence[int], outputs: int, layer_norm: bool) -> None:
        super().__init__()
        self.first = Critic(features, hidden, outputs, layer_norm)
        self.second = Critic(features, hidden, outputs, layer_norm)

    def forward(self, features: Tensor, action: Tensor) -> tuple[Tensor, Tensor]:
        """Estimates of both critics, each `[B, outputs]`."""
        return self.first(features, action), self.second(features, action)
