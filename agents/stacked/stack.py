"""What S agents have together, and how room is made for them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import torch

from agents.config import ConfigError
from agents.evasion import EvasionDomain
from agents.hyperparameters import Hyperparameters
from agents.stacked.agent import Agent
from agents.stacked.encoder import Encoder
from agents.stacked.guides import StackedGuides
from agents.stacked.lanes import Lanes
from agents.stacked.learner import StackedTd3
from agents.stacked.replay import StackedReplay
from agents.stacked.warp_worlds import WarpWorlds
from agents.stacked.worlds import HostWorlds, Worlds
from agents.task import Domain
from sim.scenario import Sensor

Simulator = Literal["device", "host"]
"""Where worlds are flown: with the learners, or on the processor whatever the learners' device."""


@dataclass
class Stack:
    """Everything of S agents that is stacked."""

    learner: StackedTd3
    replay: StackedReplay
    guides: StackedGuides
    worlds: Worlds
    lanes: Lanes
    encoder: Encoder

    def take(self, agents: list[int]) -> Stack:
        """The stack of these agents alone, in this order."""
        parts = (self.learner, self.replay, self.guides, self.worlds, self.lanes)
        return Stack(*(part.take(agents) for part in parts), self.encoder)  # type: ignore[arg-type]


def empty_stack(
    agents: Sequence[Agent], domain: Domain, hyper: Hyperparameters, device: torch.device, simulator: Simulator
) -> Stack:
    """Room for all agents, as wide as the union of all subtasks they will ever meet."""
    subtasks = sorted({number for agent in agents for task, _ in agent.legs for number in domain.subtasks(task)})
    features = domain.features(domain.layout(tuple(subtasks)))
    encoder, count, limit = Encoder(features, device), len(agents), domain.action_limit
    learner = StackedTd3(count, features.size, hyper, limit, device=device)
    return Stack(
        learner=learner,
        replay=StackedReplay(count, hyper.replay_size, hyper.lanes, features.size, device),
        guides=StackedGuides(count, learner.actor.shape, encoder, limit, device),
        worlds=worlds_for(agents, domain, features.layout, hyper.lanes, device, simulator),
        lanes=Lanes.empty(count, hyper.lanes, features.layout.size, features.size, device),
        encoder=encoder,
    )


def common_hyperparameters(each: Sequence[Hyperparameters]) -> Hyperparameters:
    """The numbers that all agents share; only the number of epochs may differ.

    Raises:
        ConfigError: there is no agent, or other numbers differ.
    """
    if not each:
        raise ConfigError("there is nothing to train; give at least one seed and one variant")
    if len({dataclasses.replace(hyper, epochs=1) for hyper in each}) > 1:
        raise ConfigError("agents of different profiles cannot be stacked; train each profile by itself")
    return each[0]


def worlds_for(
    agents: Sequence[Agent], domain: Domain, layout: Any, lanes: int, device: torch.device, simulator: Simulator
) -> Worlds:
    """The simulator on the learners' device, where it is the domain's and every scenario's sensors are perfect."""
    perfect = isinstance(domain, EvasionDomain) and all(
        task.scenario.sensor == Sensor() for agent in agents for task, _ in agent.legs
    )
    if simulator == "device" and perfect:
        return WarpWorlds(layout, len(agents), lanes, device)
    return HostWorlds(domain, layout, len(agents), lanes, device)
