"""The guides of all agents: networks stacked like actors, the navigation expert by its column, other rules as they are.

A guide sees Ξ(s), the columns of its source task. As features those are columns of the agent's own features, so a guide
network is one over the stack's features whose other inputs weigh nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum, auto

import numpy as np
import torch
from torch import Tensor

from agents.expert import NavigationExpert
from agents.layers import Shape, layers_of
from agents.passes import actions
from agents.policy import NetworkPolicy, Policy
from agents.stacked.encoder import Encoder, feature_names
from agents.stacked.residence import Weights, write_weights
from agents.stage import Stage

EXIT_COLUMN = "phi_exit"


class Kind(Enum):
    """How a guide's actions are found."""

    NONE = auto()
    """The variant has no guide; its own action stands in, as in `agents.collection`."""
    NETWORK = auto()
    NAVIGATION = auto()
    RULE = auto()
    """Anything else: asked on the host."""


class StackedGuides:
    """μ_i of every agent's stage."""

    def __init__(self, agents: int, shape: Shape, encoder: Encoder, action_limit: float, device: torch.device) -> None:
        """Nobody is guided until `place` says so; guide networks have the actors' `shape`."""
        self.shape, self.encoder, self.limit, self.device = shape, encoder, action_limit, device
        self.kinds = [Kind.NONE] * agents
        self.stages: list[Stage | None] = [None] * agents
        self._flat = torch.zeros((agents, shape.size), device=device)
        self._layers = layers_of(self._flat, shape)
        self._are = {kind: torch.zeros((agents, 1, 1), dtype=torch.bool, device=device) for kind in Kind}

    def place(self, agent: int, stage: Stage) -> None:
        """From now on an agent is guided as its stage says."""
        self.stages[agent], self.kinds[agent] = stage, self._kind(stage)
        for kind, those in self._are.items():
            those[agent] = kind is self.kinds[agent]
        if self.kinds[agent] is Kind.NETWORK:
            assert isinstance(stage.guide, NetworkPolicy)
            seen = set(feature_names(stage.domain.features(stage.source.layout)))
            known = [name if name in seen else None for name in feature_names(stage.guide.features)]
            weights = _only(list(stage.guide.layers), [name is not None for name in known])
            columns = [self.encoder.names.index(name) for name in known if name is not None]
            write_weights(self._layers, agent, weights, columns)

    def _kind(self, stage: Stage) -> Kind:
        if not stage.variant.guided:
            return Kind.NONE
        if type(stage.guide) is NavigationExpert:
            return Kind.NAVIGATION
        return Kind.NETWORK if _stackable(stage.guide, stage, self.shape) else Kind.RULE

    @torch.no_grad()
    def actions(self, features: Tensor, observation: Tensor, own: Tensor) -> Tensor:
        """Actions `[S, L, 1]` [rad] for features `[S, L, f]` and observations `[S, L, d]` of the widest layout."""
        found = own.clone()
        if Kind.NETWORK in self.kinds:
            given = (actions(self._layers, features) * self.limit).clamp_(-self.limit, self.limit)
            found = torch.where(self._are[Kind.NETWORK], given, found)
        if Kind.NAVIGATION in self.kinds:
            column = self.encoder.features.layout.names.index(EXIT_COLUMN)
            given = observation[..., column : column + 1].clamp(-self.limit, self.limit)
            found = torch.where(self._are[Kind.NAVIGATION], given, found)
        for agent, kind in enumerate(self.kinds):
            if kind is Kind.RULE:
                found[agent] = self._asked(agent, observation[agent])
        return found

    def take(self, agents: Sequence[int]) -> StackedGuides:
        """The guides of these agents alone, in this order."""
        other = StackedGuides(len(agents), self.shape, self.encoder, self.limit, self.device)
        other.kinds, other.stages = [self.kinds[one] for one in agents], [self.stages[one] for one in agents]
        other._flat.copy_(self._flat[list(agents)])
        for kind, those in other._are.items():
            those.copy_(self._are[kind][list(agents)])
        return other

    def _asked(self, agent: int, observation: Tensor) -> Tensor:
        stage = self.stages[agent]
        assert stage is not None
        names = self.encoder.features.layout.names
        shared = observation.cpu().numpy()[:, [names.index(name) for name in stage.source.layout.names]]
        action = np.clip(stage.guide.act(shared, stage.source.layout), -self.limit, self.limit)
        return torch.from_numpy(np.asarray(action, np.float32)).to(self.device)


def _stackable(guide: Policy, stage: Stage, shape: Shape) -> bool:
    """Whether a guide is a network of the actors' own widths, bends and features."""
    if not isinstance(guide, NetworkPolicy) or (guide.activation, guide.squash) != ("relu", "tanh"):
        return False
    widths = tuple(weight.shape[0] for weight, _ in guide.layers)
    same = guide.features == stage.domain.features(guide.layout)
    return widths == shape.widths[1:] and same and guide.action_limit == stage.domain.action_limit


def _only(weights: Weights, columns: list[bool]) -> Weights:
    (first, bias), *rest = weights
    return [(first[:, np.array(columns)], bias), *rest]
