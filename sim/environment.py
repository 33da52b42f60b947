"""Gymnasium environments: `SubMas/Evasion-v0` for one engagement, and its batched `VectorEnv`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask
from sim.world import Fate, Outcome, World

HALF_TURN = np.float32(np.pi / 2)


def action_space() -> gymnasium.spaces.Box:
    """Turning angle in [-pi/2, pi/2] [rad], shape (1,)."""
    return gymnasium.spaces.Box(-HALF_TURN, HALF_TURN, (1,), np.float32)


def observation_space(task: Task) -> gymnasium.spaces.Box:
    """Bounds of Table 1 for a task `[d]`: positions and ranges [m], angles [rad], blocks down to [-1, -pi]."""
    # Twice the battlefield and then some: an aircraft may leave it for a few steps, a missile may overshoot.
    far = 2.0 * np.hypot(task.scenario.battlefield.length_m, task.scenario.battlefield.width_m)
    own_low, own_high = (
        [-far, -far, -np.pi, 0.0, -np.pi, -np.pi, -np.pi],
        [far, far, np.pi, far, np.pi, np.pi, np.pi],
    )
    low, high = own_low + [-1.0, -np.pi] * len(task.missiles), own_high + [far, np.pi] * len(task.missiles)
    return gymnasium.spaces.Box(np.array(low, np.float32), np.array(high, np.float32))


def make_task(scenario: str = "default", mask: str | tuple[int, ...] = "") -> Task:
    """The task of `gymnasium.make(..., scenario=..., mask=...)`; a mask is `"1,2"` or `(1, 2)`."""
    loaded = load_scenario(scenario)
    text = mask if isinstance(mask, str) else ",".join(map(str, mask))
    return Task(loaded, parse_mask(text, loaded.launch.missiles))


class EvasionEnv(gymnasium.Env[Any, Any]):
    """One UAV flies past missiles to the exit (section 2.3).

    Action: `Box(1,)` turning angle [rad]. Observation: `Box(d,)`, Table 1 in metres and radians. Reward: +400 exit,
    +50 per missile evaded, -400 shot down or out of the battlefield for more than 10 steps, -0.1 per step. Terminated
    by exit or loss; truncated after 1200 steps. `info` of the last step holds `outcome` and `missiles_evaded`.

    Args:
        scenario: name of a shipped scenario or path of a scenario file.
        mask: masked missiles, `"3,4"` or `(3, 4)`.
        render_mode: none is offered; replays are the workbench's.
    """

    metadata = {"render_modes": []}  # noqa: RUF012  (Gymnasium's own convention)

    def __init__(self, scenario: str = "default", mask: str | tuple[int, ...] = "", render_mode: None = None) -> None:
        self.task = make_task(scenario, mask)
        self.render_mode = render_mode
        self.observation_space = observation_space(self.task)
        self.action_space = action_space()
        self._world: World | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray, dict[str, Any]]:
        """Start an episode; the same seed gives the same initial state on every mask."""
        super().reset(seed=seed)
        if seed is not None or self._world is None:
            start_seed = int(self.np_random.integers(2**62)) if seed is None else seed
            self._world = World(self.task, lanes=1, seed=start_seed)
            return self._world.observation[0], {}
        return self._world.reset()[0], {}

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray, float, bool, bool, dict[str, Any]]:
        """Fly one second with a turning angle `(1,)` [rad]."""
        if self._world is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        step = self._world.step(action)
        info = _summary(self._world, 0) if step.terminated[0] or step.truncated[0] else {}
        reward = float(step.reward_terms[0].sum(dtype=np.float64))
        return step.observation[0], reward, bool(step.terminated[0]), bool(step.truncated[0]), info


class EvasionVectorEnv(VectorEnv):
    """`num_envs` engagements at once, restarting in the same step: the last observation is in `info["final_obs"]`."""

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP}  # noqa: RUF012

    def __init__(self, num_envs: int = 1, scenario: str = "default", mask: str | tuple[int, ...] = "") -> None:
        self.task = make_task(scenario, mask)
        self.num_envs = num_envs
        self.single_observation_space, self.single_action_space = observation_space(self.task), action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._world: World | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray, dict[str, Any]]:
        """Start all episodes anew; a seed fixes all that follow."""
        super().reset(seed=seed)
        if seed is None and self._world is not None:
            return self._world.reset(), {}
        start_seed = int(self.np_random.integers(2**62)) if seed is None else seed
        self._world = World(self.task, self.num_envs, start_seed)
        return self._world.observation, {}

    def step(self, actions: NDArray[np.float32]) -> tuple[NDArray, NDArray, NDArray, NDArray, dict[str, Any]]:
        """Fly one second; lanes that end are restarted at once (SAME_STEP)."""
        if self._world is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        step = self._world.step(actions)
        ended = step.terminated | step.truncated
        info: dict[str, Any] = {}
        observation = step.observation
        for lane in np.flatnonzero(ended).tolist():
            last = {"final_obs": step.observation[lane], "final_info": _summary(self._world, lane)}
            info = self._add_info(info, last, lane)
        if ended.any():
            observation = self._world.reset(ended)
        reward = step.reward_terms.sum(axis=1, dtype=np.float64)
        return observation, reward, step.terminated, step.truncated, info


def _summary(world: World, lane: int) -> dict[str, Any]:
    evaded = int((world.fate[lane] == Fate.EVADED).sum())
    return {"outcome": Outcome(int(world.outcome[lane])).name.lower(), "missiles_evaded": evaded}
