"""A task's lanes as Stable-Baselines3 wants its environments (§4.3): finished lanes start anew within the step."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from stable_baselines3.common.vec_env import VecEnv

from agents.task import GOAL_REACHED, BoolArray, Domain, FloatArray, SubtaskTask
from agents.training_state import TRAINING_WINDOW, FinishedEpisode


class TaskVecEnv(VecEnv):
    """A `TaskWorld` behind Stable-Baselines3's `VecEnv`, with what our own learner sees and is paid.

    Observations are the encoded features `[L, f]`, actions radians within the action limit `[L, 1]`, rewards the sum
    of all terms times `reward_scale`. The true last observation of an episode and whether the step limit cut it off
    are in its lane's info, as `terminal_observation` and `TimeLimit.truncated`: learners bootstrap through the limit.
    """

    def __init__(self, domain: Domain, task: SubtaskTask, lanes: int, seed: int, reward_scale: float) -> None:
        self.world = domain.world(task, lanes, seed)
        self.features = domain.features(task.layout)
        self.reward_scale = np.float32(reward_scale)
        self.finished: deque[FinishedEpisode] = deque(maxlen=TRAINING_WINDOW)
        """Latest finished episodes; their returns carry no scale."""
        self.lane_return = np.zeros(lanes, np.float32)
        """Return of the running episodes `[L]`, without scale."""
        self._actions = np.zeros((lanes, 1), np.float32)
        self.action_limit = np.float32(domain.action_limit)
        """Actions lie in [-limit, limit] [rad]."""
        limit = self.action_limit
        super().__init__(
            lanes, Box(-np.inf, np.inf, (self.features.size,), np.float32), Box(-limit, limit, (1,), np.float32)
        )

    def reset(self) -> FloatArray:
        """Start every lane anew; features `[L, f]`."""
        self.lane_return[:] = 0.0
        return self.features.encode(self.world.reset())

    def step_async(self, actions: FloatArray) -> None:
        """Keep the actions `[L, 1]` [rad] for `step_wait`."""
        self._actions = np.asarray(actions, np.float32)

    def step_wait(self) -> tuple[FloatArray, FloatArray, BoolArray, list[dict[str, Any]]]:
        """Fly one decision step: features after restarts `[L, f]`, scaled rewards `[L]`, ends `[L]`, infos by lane."""
        step = self.world.step(self._actions)
        features, reward = self.features.encode(step.observation), step.reward
        over = step.terminated | step.truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        self.lane_return += reward
        if over.any():
            for lane in np.flatnonzero(over):
                cut = bool(step.truncated[lane] and not step.terminated[lane])
                infos[lane] = {"terminal_observation": features[lane].copy(), "TimeLimit.truncated": cut}
            features = self._restart(over)
        return features, (reward * self.reward_scale).astype(np.float32), over, infos

    def _restart(self, over: BoolArray) -> FloatArray:
        outcomes, steps = self.world.outcome[over], self.world.steps[over]
        for outcome, episode_return, length in zip(outcomes, self.lane_return[over], steps, strict=True):
            self.finished.append(FinishedEpisode(bool(outcome == GOAL_REACHED), float(episode_return), int(length)))
        self.lane_return[over] = 0.0
        return self.features.encode(self.world.reset(lanes=np.flatnonzero(over)))

    def close(self) -> None:
        """Nothing is held open."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute, the same for every lane; nothing is rendered.

        Raises:
            AttributeError: there is none.
        """
        value = None if attr_name == "render_mode" else getattr(self, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Lanes have no attributes of their own.

        Raises:
            NotImplementedError: always.
        """
        raise NotImplementedError(f"{attr_name} cannot be set: lanes have no attributes of their own")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Lanes have no methods of their own.

        Raises:
            NotImplementedError: always.
        """
        raise NotImplementedError(f"{method_name} cannot be called: lanes have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """No lane is wrapped."""
        return [False for _ in self._get_indices(indices)]
