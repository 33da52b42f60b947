"""Trains many agents together: Algorithm 4 and 5 for all of them, in step with each other.

All agents share an epoch's steps, and each ends its stage by itself: whoever is promoted begins the next stage with the
next epoch, in the same place of the stack with a network of its own size, and waits for nobody. A smaller task's
columns are zeros, so agents of different stages fit side by side, and no stage is held up by the slowest seed. Whoever
has come to the end of the chain leaves, and the stack becomes smaller.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import torch

from agents.evasion import EVASION
from agents.hyperparameters import Hyperparameters
from agents.numerics import matmul_route, prepare_torch
from agents.snapshot import Snapshot
from agents.stacked.agent import Abandoned, Agent, HostActor, HostLearner, Member
from agents.stacked.collection import collect
from agents.stacked.departure import snapshot_of
from agents.stacked.residence import actor_weights, move_in
from agents.stacked.stack import Simulator, common_hyperparameters, empty_stack
from agents.stacked.update_block import UpdateBlock
from agents.stacked.warp_worlds import on_torchs_stream
from agents.task import Domain
from agents.td3 import LearnerStatistics, Td3
from agents.training_state import EpochCounts


def train_stacked(
    members: Sequence[Member],
    device: str = "cpu",
    *,
    domain: Domain | None = None,
    hyperparameters: Hyperparameters | None = None,
    simulator: Simulator = "device",
) -> None:
    """Train all members to their ends; each recorder is told what a training by itself would tell it.

    Args:
        members: trainings of one profile; seeds, variants, tasks and guides may differ.
        device: where the learners are, `cpu` or for example `cuda:0`.
        domain: where tasks come from; the paper's domain by default, with its simulator on the same device.
        hyperparameters: numbers to use instead of those of the configured profile.
        simulator: where the worlds are flown.

    Raises:
        ConfigError: no members, profiles that differ, or a variant that cannot be stacked.
    """
    prepare_torch()
    StackedTraining(members, device, domain, hyperparameters, simulator).run()


class StackedTraining:
    """The agents that are still learning, and their stack; nothing else remembers anything between two steps."""

    def __init__(
        self,
        members: Sequence[Member],
        device: str = "cpu",
        domain: Domain | None = None,
        hyperparameters: Hyperparameters | None = None,
        simulator: Simulator = "device",
    ) -> None:
        """Make room for everybody; arguments as in `train_stacked`."""
        self.device = torch.device(device)
        domain = domain or EVASION
        each = [hyperparameters or one.config.hyperparameters for one in members]
        self.agents = [Agent(one, domain, hyper) for one, hyper in zip(members, each, strict=True)]
        self.hyper = common_hyperparameters(each)
        self.stack = empty_stack(self.agents, domain, self.hyper, self.device, simulator)
        self._numerics = (
            f"{len(members)} agents stacked on {device_name(self.device)}; matrix products: {matmul_route()}"
        )
        self._pool = ThreadPoolExecutor(min(len(members), _cores()))
        self.block = UpdateBlock(self.stack, self.hyper)
        for place in range(len(self.agents)):
            self._begin(place)
        self._leave()

    def run(self) -> None:
        """Epoch after epoch, until everybody is done."""
        with self._pool, on_torchs_stream(self.device):
            while self.agents:
                self.run_epoch()
                self.close_epoch()

    def run_epoch(self) -> None:
        """Alternate one step of all lanes and a fixed number of gradient steps (Algorithm 4, lines 4-22)."""
        steps = 0
        for agent in self.agents:
            agent.state.epoch += 1
            agent.state.counts = EpochCounts()
        while steps < self.hyper.steps_per_epoch and self.agents:
            steps += self.step()
            self._dismiss()
        lanes = self.stack.lanes
        for agent, allowed, guided in zip(self.agents, lanes.allowed.tolist(), lanes.guided.tolist(), strict=True):
            agent.state.counts.transfer_allowed, agent.state.counts.guided = allowed, guided
        lanes.allowed.zero_()
        lanes.guided.zero_()

    def step(self) -> int:
        """One step of all lanes and the updates that follow it; the number of transitions of each agent."""
        for agent, episodes in zip(self.agents, collect(self.stack, self.hyper), strict=True):
            agent.state.finished.extend(episodes)
            agent.state.env_steps += self.hyper.lanes
            agent.state.counts.steps += self.hyper.lanes
        waiting = np.flatnonzero(self.stack.replay.size < max(self.hyper.update_after, 1)).tolist()
        if len(waiting) < len(self.agents):
            self.block(waiting)
            for place in set(range(len(self.agents))) - set(waiting):
                self.agents[place].state.counts.updates += self.hyper.updates_per_lane_step
        return self.hyper.lanes

    def _dismiss(self) -> None:
        """Let those go who were told to end at once."""
        for agent in self.agents:
            if agent.member.abandoned():
                agent.over, agent.failure = True, Abandoned()
        self._leave()

    def close_epoch(self) -> None:
        """Let every agent evaluate and decide, side by side; begin next stages, and let those go who are done."""
        self._fetch()
        takes = [partial(self._snapshot, place) for place in range(len(self.agents))]
        policies = list(self._pool.map(Agent.close_epoch, self.agents, takes))
        for place, (agent, policy) in enumerate(zip(self.agents, policies, strict=True)):
            if agent.over:
                continue
            if policy is not None:
                agent.advance(policy)
                self._begin(place)
            self.stack.lanes.alpha[place] = agent.state.alpha
            self.stack.lanes.epsilon[place] = agent.state.epsilon
        self._leave()

    def _snapshot(self, place: int) -> Snapshot:
        agent = self.agents[place]
        return snapshot_of(agent.stage, agent.state, self.stack, place)

    def _begin(self, place: int) -> None:
        """Fresh networks, an empty replay and a fresh world for an agent's stage (Algorithm 4, lines 1-2)."""
        agent, stack, hyper = self.agents[place], self.stack, self.hyper
        stage = agent.stage
        try:
            agent.begin(self._numerics)
        except Exception as error:  # of a recorder: a run that was asked to stop, or a full disk
            agent.over, agent.failure = True, error
            return
        features = stage.domain.features(stage.task.layout)
        fresh = Td3(features.size, hyper, stage.domain.action_limit, stage.seed)
        move_in(stack.learner, place, fresh, stack.encoder.columns(features))
        stack.replay.clear(place)
        stack.guides.place(place, stage)
        lanes = stack.lanes
        lanes.clear(place)
        lanes.seeds[place] = stage.seed
        lanes.restarted[place] = True
        lanes.alpha[place], lanes.epsilon[place] = agent.state.alpha, agent.state.epsilon
        lanes.fresh[place] = stack.encoder.fresh_flags(stage.task.layout, stage.source.layout)
        lanes.observation[place] = stack.worlds.open(place, stage)
        lanes.features[place] = stack.encoder.encode(lanes.observation[place])

    def _fetch(self) -> None:
        """Bring to the host what the end of an epoch asks of the learners."""
        learner, scale = self.stack.learner, self.hyper.reward_scale
        sums = torch.cat((learner.critic_sums, learner.actor_sums[:, None]), dim=1).tolist()
        learner.critic_sums.zero_()
        learner.actor_sums.zero_()
        for place, (agent, (critic, q, actor)) in enumerate(zip(self.agents, sums, strict=True)):
            columns = self.stack.encoder.columns(agent.domain.features(agent.stage.task.layout))
            actors = [
                HostActor(actor_weights(learner, flat, place, columns))
                for flat in (learner.actor.values, learner.average_actor)
            ]
            made, done = agent.state.counts.updates, int(learner.updates[place])
            turns = done // self.hyper.policy_delay - (done - made) // self.hyper.policy_delay
            means = LearnerStatistics(critic / max(made, 1), actor / max(turns, 1), q / max(made, 1) / scale)
            agent.state.learner = HostLearner(*actors, done, means)  # type: ignore[assignment]

    def _leave(self) -> None:
        """Let those go who are done; the others move together."""
        staying = [place for place, agent in enumerate(self.agents) if not agent.over]
        if len(staying) == len(self.agents):
            return
        for agent in self.agents:
            if agent.over:
                agent.member.ended(agent.failure)
        self.agents = [self.agents[place] for place in staying]
        if staying:
            self.stack = self.stack.take(staying)
            self.block = UpdateBlock(self.stack, self.hyper)


def device_name(device: torch.device) -> str:
    """What a person calls a device."""
    return torch.cuda.get_device_name(device) if device.type == "cuda" else "the processor"


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
