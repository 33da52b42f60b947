"""Collecting experience for all agents at once: lines 4 to 9 of Algorithm 4, as `agents.collection` for one."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from agents.hyperparameters import Hyperparameters
from agents.stacked.draws import Purpose, normal, uniform
from agents.stacked.lanes import Lanes
from agents.stacked.stack import Stack
from agents.task import GOAL_REACHED, RUNNING
from agents.training_state import FinishedEpisode


@torch.no_grad()
def collect(stack: Stack, hyper: Hyperparameters) -> list[list[FinishedEpisode]]:
    """One step of all lanes of all agents: act, observe, store, start finished lanes anew.

    Returns:
        The episodes that ended, by agent.
    """
    lanes, limit = stack.lanes, stack.learner.action_limit
    allowed = (lanes.features * lanes.fresh[:, None]).sum(dim=2) == 0.0
    own = stack.learner.act(lanes.features) * limit
    guide = stack.guides.actions(lanes.features, lanes.observation, own)
    action = explore(own, guide, allowed, lanes, hyper, limit)
    distance = torch.linalg.vector_norm(action - guide, dim=2)
    imitation = torch.where(allowed, -distance, torch.zeros_like(distance))  # Eq. (15)
    step = stack.worlds.step(action)
    features = stack.encoder.encode(step.observation)
    # The end of an episode by the step limit is not stored as an end: its value goes on.
    scalars = torch.stack((step.reward, imitation, step.terminated.float(), step.over.float()), dim=2)
    stack.replay.add(lanes.features, action / limit, scalars, features)
    lanes.episode_return += step.reward
    lanes.episode_steps += 1
    lanes.allowed += allowed.sum(dim=1)
    lanes.guided += (lanes.reused & allowed).sum(dim=1)
    lanes.steps += 1
    lanes.observation.copy_(step.observation)
    lanes.features.copy_(features)
    lanes.restarted.copy_(step.over)
    return _restart(stack, step.outcome)


def explore(own: Tensor, guide: Tensor, allowed: Tensor, lanes: Lanes, hyper: Hyperparameters, limit: float) -> Tensor:
    """A = μ_b(s) + δ, clipped to the action range `[S, L, 1]` [rad]: Algorithm 4, line 5; Eq. (17), (18).

    Draws of ε hold for a segment, draws of the noise for a while, as `agents.reuse` and `agents.exploration` say.
    """
    shape, counts = lanes.reused.shape[1:], lanes.steps
    end, reuse = uniform(lanes.seeds, Purpose.SEGMENT, counts, (2, *shape)).unbind(dim=1)
    ended = lanes.restarted | (end < 1.0 / hyper.segment_steps)
    lanes.reused.copy_(torch.where(ended, reuse < lanes.epsilon[:, None], lanes.reused))
    composite = torch.where(allowed[..., None], guide, own)
    action = torch.where(lanes.reused[..., None], composite, own)
    fresh = (normal(lanes.seeds, Purpose.NOISE, counts, (*shape, 1)) * hyper.action_noise).float()
    if hyper.noise_steps > 1:
        end = uniform(lanes.seeds, Purpose.NOISE_END, counts, shape)
        ended = lanes.restarted | (end < 1.0 / hyper.noise_steps)
        fresh = torch.where(ended[..., None], fresh, lanes.noise)
    lanes.noise.copy_(fresh)
    return (action + lanes.noise).clamp(-limit, limit)


def _restart(stack: Stack, outcome: Tensor) -> list[list[FinishedEpisode]]:
    """Start finished lanes anew; the only time in a step at which the host waits for the device."""
    lanes = stack.lanes
    told = torch.stack((outcome.float(), lanes.episode_return, lanes.episode_steps), dim=2).cpu().numpy()
    over = told[..., 0] != RUNNING
    finished: list[list[FinishedEpisode]] = [[] for _ in over]
    if not over.any():
        return finished
    for agent, lane in np.argwhere(over):
        code, episode_return, steps = told[agent, lane]
        finished[agent].append(FinishedEpisode(bool(code == GOAL_REACHED), float(episode_return), int(steps)))
    ended = torch.from_numpy(over).to(outcome.device)
    lanes.episode_return.masked_fill_(ended, 0.0)
    lanes.episode_steps.masked_fill_(ended, 0.0)
    lanes.observation.copy_(stack.worlds.restart(over))
    lanes.features.copy_(stack.encoder.encode(lanes.observation))
    return finished
