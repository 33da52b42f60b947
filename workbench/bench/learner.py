"""How many gradient steps a second the learner makes here, beside its readable twin and Stable-Baselines3's TD3.

All three have the same sizes and algorithm (Table 2), draw their batches from a full replay, run on one thread and take
turns, so that whatever else the machine does slows all. The learner chooses its matrix products (`agents.numerics`);
the others are measured as they come, with torch's own, and once more with the same as the learner.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import torch

from agents.evasion import EVASION
from agents.hyperparameters import FAST, PAPER, Hyperparameters
from agents.numerics import prepare_torch
from agents.replay import Replay
from agents.td3 import Td3
from agents.td3_fast import FastTd3
from sim.task import Task, task_for

BATCHES = (128, 256)
ROUNDS = 7
SLICE_S = 0.4
UPDATES = 50
"""Updates between two steps of the environment in the paper's profile, and the least that is timed."""
STORED = 50_000
OWN = "default"
"""Route of torch's own matrix products."""
Progress = Callable[[int, int], None]
Updates = Callable[[int], None]
"""Makes that many gradient steps."""


@dataclass(frozen=True)
class LearnerCase:
    """One row of `workbench bench learner`."""

    batch: int
    device: str
    updates_per_s: float
    """The learner that trains."""
    reference_updates_per_s: float
    """The same by autograd, `agents.td3.Td3`, with torch's own matrix products."""
    sb3_updates_per_s: float
    """Stable-Baselines3's TD3, likewise."""
    reference_same_products_updates_per_s: float
    """By autograd with the learner's matrix products: what hand-written gradients alone are worth."""
    sb3_same_products_updates_per_s: float
    """Stable-Baselines3's TD3, likewise."""


@dataclass(frozen=True)
class LearnerBench:
    """What `workbench bench learner` measures."""

    cases: list[LearnerCase]
    fast_profile_updates_per_s: float
    """The learner with the profile `fast`: layer norm, two returns, ten-step rewards."""
    matrix_products: str
    """Route of the learner's matrix products, see `agents.numerics`."""


def bench_learner(
    batches: Sequence[int] = BATCHES,
    rounds: int = ROUNDS,
    slice_s: float = SLICE_S,
    stored: int = STORED,
    progress: Progress | None = None,
) -> LearnerBench:
    """Measure gradient steps per second.

    Args:
        batches: batch sizes.
        rounds: the learners take turns this often; each rate is the median.
        slice_s: shortest time of one turn [s].
        stored: transitions in the replay.
        progress: told how many rounds of how many are done.
    """
    before = torch.get_num_threads()
    route = prepare_torch()
    task = task_for()
    groups = [_compared(task, dataclasses.replace(PAPER, batch_size=batch), stored, route) for batch in batches]
    groups.append([_on(route, our_updates(FastTd3, task, FAST, stored))])
    medians: list[list[float]] = []
    for done, group in enumerate(groups):
        medians.append(_in_turns(group, rounds, slice_s))
        if progress is not None:
            progress(done + 1, len(groups))
    torch.set_num_threads(before)
    cases = [LearnerCase(batch, "cpu", *rates) for batch, rates in zip(batches, medians[:-1], strict=True)]
    return LearnerBench(cases, medians[-1][0], route)


def _compared(task: Task, hyper: Hyperparameters, stored: int, route: str) -> list[Updates]:
    """What takes turns, in the order of the rates in `LearnerCase`."""
    fast, readable = (our_updates(learner, task, hyper, stored) for learner in (FastTd3, Td3))
    others = readable, sb3_updates(task, hyper, stored)
    return [_on(route, fast), *(_on(products, other) for products in (OWN, route) for other in others)]


def _on(route: str, updates: Updates) -> Updates:
    """The same with matrix products of this route."""

    def turn(count: int) -> None:
        prepare_torch(route=route)
        updates(count)

    return turn


def _in_turns(group: list[Updates], rounds: int, slice_s: float) -> list[float]:
    """Median updates per second of each, taking turns; the first turn only warms up."""
    rates: list[list[float]] = [[] for _ in group]
    for turn in range(rounds + 1):
        for found, updates in zip(rates, group, strict=True):
            made, began, spent_s = 0, time.perf_counter(), 0.0
            while spent_s < (slice_s if turn else 0.0) or not made:
                updates(UPDATES)
                made += UPDATES
                spent_s = time.perf_counter() - began
            found.append(made / spent_s)
    return [float(np.median(found[1:])) for found in rates]


def our_updates(learner_class: type[Td3], task: Task, hyper: Hyperparameters, stored: int) -> Updates:
    """Gradient steps of one of our learners on a full replay of random transitions."""
    features = EVASION.features(task.layout).size
    learner = learner_class(features, hyper, EVASION.action_limit, seed=0)
    replay, draws = Replay(stored, hyper.lanes, features), np.random.default_rng(0)
    shape = (hyper.lanes, features)
    for _ in range(replay.slots):
        columns = draws.normal(size=(3, hyper.lanes)).astype(np.float32)
        ended = draws.random(hyper.lanes) < 1e-3
        observed, after = draws.normal(size=(2, *shape)).astype(np.float32)
        replay.add(observed, np.tanh(columns[0])[:, None], columns[1], columns[2], ended, ended, after)
    generator = torch.Generator().manual_seed(0)

    def updates(count: int) -> None:
        for batch in replay.minibatches(count, hyper.batch_size, hyper.return_steps, hyper.gamma, generator):
            learner.update(batch, alpha=0.5)

    return updates


def sb3_updates(task: Task, hyper: Hyperparameters, stored: int) -> Updates:
    """Gradient steps of Stable-Baselines3's TD3, its own `train()`, with the same sizes on a full buffer."""
    from stable_baselines3 import TD3
    from stable_baselines3.common.logger import configure

    env = _Spaces(EVASION.features(task.layout).size)
    model = TD3(
        "MlpPolicy", env, learning_rate=hyper.learning_rate, buffer_size=stored, batch_size=hyper.batch_size,
        tau=hyper.polyak, gamma=hyper.gamma, policy_delay=hyper.policy_delay, seed=0, device="cpu",
        policy_kwargs={"net_arch": list(hyper.hidden)},
    )  # fmt: skip
    model.set_logger(configure(None, []))
    buffer: Any = model.replay_buffer
    draws = np.random.default_rng(0)
    for array in (buffer.observations, buffer.next_observations, buffer.actions, buffer.rewards):
        array[:] = np.tanh(draws.normal(size=array.shape))
    buffer.full = True
    return lambda count: model.train(gradient_steps=count, batch_size=hyper.batch_size)


class _Spaces(gymnasium.Env[np.ndarray, np.ndarray]):
    """An environment that nobody steps: Stable-Baselines3 asks it for the sizes."""

    def __init__(self, features: int) -> None:
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (features,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)
