"""SAC and PPO of Stable-Baselines3 (§4.3) with the numbers of a profile, and what reports ask of a learner.

Table 2 gives networks, rate and batch. Features, reward scale, discount and lanes are those of our own learner in the
same profile, for SAC also replay, n-step returns and updates per step. Everything else follows SpinningUp, as in the
paper. No choice is made to hold a baseline back: where the literal number would, another is taken and the reason given.
"""

from __future__ import annotations

import sys
import warnings
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.logger import Logger
from torch import nn

from agents.arrays import Arrays
from agents.baselines_state import BufferSlots, model_arrays, restore_model
from agents.baselines_world import TaskVecEnv
from agents.hyperparameters import Hyperparameters
from agents.replay import StoredSlots
from agents.task import FloatArray

Layers = list[tuple[FloatArray, FloatArray]]

RANDOM_STEPS: Final = 10_000
"""Uniformly random steps before SAC acts by its policy, SpinningUp's `start_steps`; an epoch at most."""
ENTROPY_WEIGHT: Final = 0.2
"""SpinningUp's weight of SAC's entropy, in units of the unscaled reward."""
PPO_PASSES: Final = 10
"""Passes of PPO over each rollout, Stable-Baselines3's number."""
SEEDS: Final = 2**32
"""Stable-Baselines3 seeds NumPy's old generator, which takes no larger numbers."""


@dataclass(frozen=True)
class Losses:
    """Means over the latest epoch, None where nothing was learned; the library tells no mean action value."""

    critic_loss: float | None
    actor_loss: float | None
    q_mean: None = None


class LossMeans(Logger):
    """Stable-Baselines3's logger, but it prints nothing and keeps what it is told until it is asked."""

    def __init__(self) -> None:
        super().__init__(folder=None, output_formats=[])
        self._told: defaultdict[str, list[float]] = defaultdict(list)

    def record(self, key: str, value: Any, exclude: str | tuple[str, ...] | None = None) -> None:
        """Remember a figure."""
        self._told[key].append(float(value))

    def take(self, *keys: str) -> list[float | None]:
        """Means of these figures since the last call, None where there was none; everything is forgotten."""
        told, self._told = self._told, defaultdict(list)
        return [sum(told[key]) / len(told[key]) if key in told else None for key in keys]


class BaselineLearner:
    """One algorithm in training: counts its gradient steps, averages its losses, gives its weights away."""

    activation: ClassVar[str] = "relu"
    squash: ClassVar[str] = "tanh"
    losses: ClassVar[tuple[str, str]]
    """What the library calls the losses of critic and actor."""

    def __init__(self, model: SAC | PPO, optimizer: torch.optim.Optimizer) -> None:
        self.updates = 0
        """Gradient steps of the critic so far."""
        self._model = model
        self._means = LossMeans()
        model.set_logger(self._means)
        optimizer.register_step_post_hook(self._count)

    def learn(self, steps: int) -> int:
        """Take at least `steps` more environment steps, all lanes together, and learn; the steps taken in all."""
        # The interval keeps the library from summing up for a reader it does not have.
        self._model.learn(steps, log_interval=sys.maxsize, reset_num_timesteps=False)
        return self._model.num_timesteps

    def take_statistics(self) -> Losses:
        """Mean losses since the last call."""
        critic_loss, actor_loss = self._means.take(*self.losses)
        return Losses(critic_loss, actor_loss)

    def layers(self) -> Layers:
        """Copies of the deterministic policy's weights `[out, in]` and biases `[out]`, first layer to last."""
        raise NotImplementedError

    def arrays(self) -> Arrays:
        """Copies of everything that changes while learning, but for the replay; see `restore`."""
        return model_arrays(self._model) | {"updates": np.array(self.updates)}

    def restore(self, arrays: Arrays, slots: StoredSlots | None) -> None:
        """Go on from where `arrays` and `slots` were taken of a learner of the same sizes.

        Raises:
            KeyError, RuntimeError, ValueError: they are not those of such a learner.
        """
        restore_model(self._model, arrays)
        self.updates = int(arrays["updates"])
        if self.slots is not None and slots is not None:
            self.slots.restore(slots)

    @property
    def slots(self) -> BufferSlots | None:
        """The experience that is kept, by time slot."""
        return None

    @property
    def action_generator(self) -> np.random.Generator:
        """Source of the uniformly random actions at the beginning."""
        return self._model.action_space.np_random

    def _count(self, *_: object) -> None:
        self.updates += 1


class Sac(BaselineLearner):
    """Soft actor-critic: a ReLU network whose mean goes through tanh."""

    losses = ("train/critic_loss", "train/actor_loss")

    def __init__(self, env: TaskVecEnv, hyper: Hyperparameters, seed: int, literal: bool) -> None:
        """Networks and replay; `literal` takes SpinningUp's entropy weight as it is.

        Otherwise the weight is learned from there on, the library's default: with scaled rewards or another discount a
        fixed one would mean something else. Stable-Baselines3 starts its updates after the random steps; SpinningUp's
        begin 9000 steps earlier, of three million.
        """
        weight = ENTROPY_WEIGHT * hyper.reward_scale
        model = SAC(
            "MlpPolicy",
            env,
            learning_rate=hyper.learning_rate,
            buffer_size=hyper.replay_size,
            learning_starts=min(RANDOM_STEPS, hyper.steps_per_epoch),
            batch_size=hyper.batch_size,
            tau=hyper.polyak,
            gamma=hyper.gamma,
            gradient_steps=hyper.updates_per_lane_step,
            n_steps=hyper.return_steps,
            ent_coef=weight if literal else f"auto_{weight}",
            policy_kwargs={"net_arch": list(hyper.hidden)},
            seed=seed % SEEDS,
            device="cpu",
        )
        super().__init__(model, model.critic.optimizer)
        self.model = model

    @property
    def slots(self) -> BufferSlots:
        """The replay; every step of all lanes fills one slot."""
        assert self.model.replay_buffer is not None
        return BufferSlots(self.model.replay_buffer, self.model.num_timesteps // self.model.n_envs)

    def layers(self) -> Layers:
        """Weights of the mean action before its tanh."""
        return _arrays([*self.model.actor.latent_pi, self.model.actor.mu])


class Ppo(BaselineLearner):
    """Proximal policy optimisation: a tanh network whose mean is clipped to the action limit."""

    activation = "tanh"
    squash = "clip"
    losses = ("train/value_loss", "train/policy_gradient_loss")

    def __init__(self, env: TaskVecEnv, hyper: Hyperparameters, seed: int, literal: bool) -> None:
        """Networks and a rollout of one epoch, as in SpinningUp; `literal` changes nothing.

        Minibatches of Table 2 take the place of SpinningUp's whole rollouts, so its 80 steps per rollout would be one
        pass: the library's 10 are made, whatever the profile's updates per step, which are meant for a replay. They
        end by no KL bound, which here would also end the critic's steps. As in SpinningUp gradients are not clipped and
        Adam's ε is torch's own: the library clips those of actor and critic together, so that the size of the rewards
        would change the actor's steps.
        """
        rollout = -(-hyper.steps_per_epoch // env.num_envs)
        network = {"net_arch": list(hyper.hidden), "log_std_init": -0.5, "optimizer_kwargs": {"eps": 1e-8}}
        with warnings.catch_warnings():
            # 10 000 steps are no multiple of 128; the last minibatch of a pass is then smaller.
            warnings.filterwarnings("ignore", message="You have specified a mini-batch size")
            model = PPO(
                "MlpPolicy",
                env,
                learning_rate=hyper.learning_rate,
                n_steps=rollout,
                batch_size=hyper.batch_size,
                n_epochs=PPO_PASSES,
                gamma=hyper.gamma,
                gae_lambda=0.97,
                clip_range=0.2,
                max_grad_norm=float("inf"),
                policy_kwargs=network,
                seed=seed % SEEDS,
                device="cpu",
            )
        super().__init__(model, model.policy.optimizer)
        self.model = model
        self._limit = env.action_limit

    def layers(self) -> Layers:
        """Weights of the mean action as a share of the action limit; the library's is in radians."""
        *hidden, (weight, bias) = _arrays([*self.model.policy.mlp_extractor.policy_net, self.model.policy.action_net])
        return [*hidden, (weight / self._limit, bias / self._limit)]


LEARNERS: Final = {"sac": Sac, "ppo": Ppo}
"""Learners by the algorithm's name in a variant."""


def _arrays(modules: Iterable[nn.Module]) -> Layers:
    linear = [module for module in modules if isinstance(module, nn.Linear)]
    return [(layer.weight.detach().numpy().copy(), layer.bias.detach().numpy().copy()) for layer in linear]
