"""Collecting experience with the behaviour policy: lines 4 to 9 of Algorithm 4, for all lanes at once."""

from __future__ import annotations

import numpy as np
import torch

from agents.distillation import imitation_reward
from agents.exploration import held_noise
from agents.features import ObservationFeatures
from agents.reuse import behaviour_action, composite_action, draw_reuse
from agents.stage import Stage
from agents.task import GOAL_REACHED, BoolArray, FloatArray
from agents.training_state import FinishedEpisode, TrainingState
from agents.transfer_mask import TransferMask


class Collector:
    """Takes one step in every lane and stores the transitions; it holds nothing that changes."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.limit = np.float32(stage.domain.action_limit)
        self.features: ObservationFeatures = stage.domain.features(stage.task.layout)
        self.mask: TransferMask = stage.transfer_mask
        self.needs_guide = stage.variant.distillation or stage.variant.reuse

    def step(self, state: TrainingState) -> None:
        """One step of all lanes: act, observe, store, and start finished lanes anew."""
        allowed = self.mask.allowed(state.observation)
        own = self.own_action(state)
        guide = self.guide_action(state.observation) if self.needs_guide else own
        action = self.explore(own, guide, allowed, state)
        imitation = imitation_reward(action, guide, allowed)
        step = state.world.step(action)
        features = self.features.encode(step.observation)
        # The end of an episode by the step limit is not stored as an end: its value goes on.
        over = step.terminated | step.truncated
        state.replay.add(state.features, action / self.limit, step.reward, imitation, step.terminated, over, features)
        state.lane_return = state.lane_return + step.reward
        state.counts.transfer_allowed += int(allowed.sum())
        state.counts.guided += int((state.reused & allowed).sum())
        state.counts.steps += len(action)
        state.env_steps += len(action)
        state.observation, state.features = step.observation, features
        self.restart(state, over)

    def own_action(self, state: TrainingState) -> FloatArray:
        """μ_k(s): actions of the policy in training `[L, 1]` [rad]."""
        with torch.no_grad():
            return state.learner.actor(torch.from_numpy(state.features)).numpy() * self.limit

    def guide_action(self, observation: FloatArray) -> FloatArray:
        """μ_i(Ξ(s)): actions of the guide `[L, 1]` [rad], within the action limit."""
        action = self.stage.guide.act(self.mask.shared(observation), self.stage.source.layout)
        return np.clip(action, -self.limit, self.limit)

    def explore(self, own: FloatArray, guide: FloatArray, allowed: BoolArray, state: TrainingState) -> FloatArray:
        """A = μ_b(s) + δ, δ ~ 𝒩(0, σ), clipped to the action range: Algorithm 4, line 5. One draw per lane."""
        hyper = self.stage.hyper
        state.reused = draw_reuse(state.reused, state.restarted, state.epsilon, hyper.segment_steps, state.generator)
        action = behaviour_action(own, composite_action(own, guide, allowed), state.reused)
        state.noise = held_noise(state.noise, state.restarted, hyper.action_noise, hyper.noise_steps, state.generator)
        return np.clip(action + state.noise, -self.limit, self.limit).astype(np.float32)

    def restart(self, state: TrainingState, over: BoolArray) -> None:
        """Record finished episodes and start their lanes anew, after the transition has been stored."""
        state.restarted = over
        if not over.any():
            return
        outcomes, steps = state.world.outcome[over], state.world.steps[over]
        for outcome, episode_return, length in zip(outcomes, state.lane_return[over], steps, strict=True):
            success = bool(outcome == GOAL_REACHED)
            state.finished.append(FinishedEpisode(success, float(episode_return), int(length)))
        state.lane_return[over] = 0.0
        state.observation = state.world.reset(lanes=np.flatnonzero(over))
        state.features = self.features.encode(state.observation)
