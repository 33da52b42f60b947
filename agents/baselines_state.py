"""What SAC and PPO of Stable-Baselines3 go on from, as plain arrays: the library's own files hold pickles, ours none.

Both draw from the process's own generators of torch and NumPy, so these belong to it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.buffers import ReplayBuffer

from agents.arrays import Arrays, below, joined
from agents.replay import StoredSlots
from agents.task import FloatArray
from agents.torch_state import (
    array_of,
    load_module,
    load_optimizer,
    module_arrays,
    optimizer_arrays,
    tensor_of,
)


def model_arrays(model: SAC | PPO) -> Arrays:
    """Copies of networks, moments, the last observation and all generators."""
    optimizers = {name: optimizer_arrays(optimizer) for name, optimizer in _optimizers(model).items()}
    assert model._last_obs is not None, "nothing was learned yet"
    assert model._last_episode_starts is not None, "nothing was learned yet"
    last = {"observation": np.array(model._last_obs), "starts": np.array(model._last_episode_starts)}
    weight = getattr(model, "log_ent_coef", None)
    entropy = {} if weight is None else {"entropy_weight": array_of(weight)}
    networks = {"policy": module_arrays(model.policy)}
    counters = {"num_timesteps": np.array(model.num_timesteps), "n_updates": np.array(model._n_updates)}
    return joined(networks | optimizers) | last | entropy | counters | _generator_arrays()


def restore_model(model: SAC | PPO, arrays: Arrays) -> None:
    """Inverse of `model_arrays`, for a fresh model; nothing may draw a number between this and the next `learn`."""
    load_module(model.policy, below("policy", arrays))
    for name, optimizer in _optimizers(model).items():
        load_optimizer(optimizer, below(name, arrays))
    weight = getattr(model, "log_ent_coef", None)
    if weight is not None:
        weight.data.copy_(tensor_of(arrays["entropy_weight"]))
    model._last_obs, model._last_episode_starts = arrays["observation"].copy(), arrays["starts"].copy()
    model.num_timesteps, model._n_updates = int(arrays["num_timesteps"]), int(arrays["n_updates"])
    _load_generators(arrays)


def _optimizers(model: SAC | PPO) -> dict[str, torch.optim.Optimizer]:
    if isinstance(model, PPO):
        return {"optimizer": model.policy.optimizer}
    found = {"actor_optimizer": model.actor.optimizer, "critic_optimizer": model.critic.optimizer}
    return found if model.ent_coef_optimizer is None else found | {"entropy_optimizer": model.ent_coef_optimizer}


def _generator_arrays() -> Arrays:
    # The library draws with NumPy's old generator, whose state is a name, 624 words and three numbers.
    state: Any = np.random.get_state()
    _, words, *numbers = state
    return {"torch": torch.get_rng_state().numpy().copy(), "words": words, "numbers": np.array(numbers, np.float64)}


def _load_generators(arrays: Arrays) -> None:
    torch.set_rng_state(tensor_of(arrays["torch"]))
    position, has_gauss, gauss = arrays["numbers"].tolist()
    np.random.set_state(("MT19937", arrays["words"], int(position), int(has_gauss), gauss))


class BufferSlots:
    """The library's replay by time slot, as `StoredSlots`: rows hold s, s', a, r, whether it ended and was cut off."""

    def __init__(self, buffer: ReplayBuffer, added: int) -> None:
        """`added` is the number of slots stored so far, which the library does not count."""
        self.buffer = buffer
        self.added = added

    def blocks(self, first: int) -> Iterator[tuple[int, FloatArray]]:
        """Copies of the stored rows `[slots · L, 2 f + 4]` from slot number `first` on, oldest first."""
        slots = self.buffer.buffer_size
        first = max(first, self.added - slots)
        while first < self.added:
            row = first % slots
            count = min(self.added - first, slots - row)
            parts = [part[row : row + count] for part in self._parts()]
            yield first, np.concatenate(parts, axis=2).reshape(count * self.buffer.n_envs, -1)
            first += count

    def restore(self, stored: StoredSlots) -> None:
        """Fill an empty buffer; `added` must be that of `stored`.

        Raises:
            ValueError: transitions of another size, or some are missing.
        """
        buffer = self.buffer
        wanted = max(self.added - buffer.buffer_size, 0)
        for first, rows in stored.blocks(wanted):
            widths = [part.shape[2] for part in self._parts()]
            if first > wanted or len(rows) % buffer.n_envs or rows.shape[1] != sum(widths):
                raise ValueError(f"transitions {list(rows.shape)} from slot {first} on do not fit or leave a gap")
            count = len(rows) // buffer.n_envs
            numbers = np.arange(first, first + count) % buffer.buffer_size
            pieces = np.split(rows.reshape(count, buffer.n_envs, -1), np.cumsum(widths)[:-1], axis=2)
            for part, piece in zip(self._parts(), pieces, strict=True):
                part[numbers] = piece
            wanted = max(wanted, first + count)
        if wanted != self.added:
            raise ValueError(f"transitions end at slot {wanted} of {self.added}")
        buffer.pos, buffer.full = self.added % buffer.buffer_size, self.added >= buffer.buffer_size

    def _parts(self) -> list[FloatArray]:
        """Views `[slots, L, n]` of the buffer's arrays."""
        buffer = self.buffer
        scalars: list[Any] = [buffer.rewards, buffer.dones, buffer.timeouts]
        return [buffer.observations, buffer.next_observations, buffer.actions, *(part[:, :, None] for part in scalars)]
