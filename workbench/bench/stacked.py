"""How many gradient steps a second a stack of agents makes, beside one seed by itself on one core of this machine.

All take turns in one run, with the profile `fast`, full replays and one thread on the processor, so that whatever else
the machine does slows all.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from agents.config import TrainingConfig
from agents.expert import NavigationExpert
from agents.hyperparameters import FAST, Hyperparameters
from agents.numerics import prepare_torch
from agents.recorder import NoRecorder
from agents.replay import SCALARS
from agents.stacked.agent import Member
from agents.stacked.collection import collect
from agents.stacked.device import checked_device
from agents.stacked.stack import Simulator, Stack
from agents.stacked.training import StackedTraining, device_name
from agents.td3_fast import FastTd3
from sim.task import task_for
from workbench.bench.learner import STORED, UPDATES, Progress, our_updates

AGENTS = (1, 2, 5, 10)
ROUNDS = 5
SLICE_S = 0.4
Turn = Callable[[], int]
"""Does a piece of work; how much it was."""


@dataclass(frozen=True)
class StackedCase:
    """S agents together."""

    agents: int
    device: str
    batch: int
    agent_updates_per_s: float
    """Gradient steps of all agents together."""
    one_seed_updates_per_s: float
    """Gradient steps of one seed by itself, `agents.td3_fast` on one core, measured in the same run."""
    ratio: float
    """The first by the second: how many seeds by themselves, on a core each, the stack replaces."""
    collect_ms: float
    """One step of all lanes of all agents, the simulator on the device [ms]."""
    collect_host_ms: float
    """The same with the simulator on the processor [ms]."""


@dataclass(frozen=True)
class StackedBench:
    """What `workbench bench learner --device …` adds."""

    stacked: list[StackedCase]
    device_name: str
    recorded: bool
    """Whether blocks of updates ran as CUDA graphs."""


def bench_stacked(
    device: str = "cpu",
    agents: Sequence[int] = AGENTS,
    hyper: Hyperparameters = FAST,
    rounds: int = ROUNDS,
    slice_s: float = SLICE_S,
    stored: int = STORED,
    progress: Progress | None = None,
) -> StackedBench:
    """Measure updates and steps per second of stacks of several sizes.

    Args:
        device: where the stacks are; one seed by itself is always on the processor.
        agents: sizes of the stacks.
        hyper: numbers of the learners.
        rounds: all take turns this often; each rate is the median.
        slice_s: shortest time of one turn [s].
        stored: transitions in each replay.
        progress: told how many rounds of how many are done.

    Raises:
        ConfigError: there is no such device.
    """
    device = checked_device(device)
    before = torch.get_num_threads()
    prepare_torch()
    hyper = dataclasses.replace(hyper, replay_size=max(stored, 1000))
    stacks = [full_stack(count, device, hyper) for count in agents]
    turns = [_one_seed(hyper, stored), *(_updates(training, hyper) for training in stacks)]
    turns += [_steps(training.stack, hyper) for training in stacks]
    turns += [_steps(full_stack(count, device, hyper, "host").stack, hyper) for count in agents]
    rates = in_turns(turns, rounds, slice_s, progress)
    torch.set_num_threads(before)
    alone, sizes = rates[0], len(agents)
    cases = [
        StackedCase(count, device, hyper.batch_size, rate, alone, rate / alone, 1e3 / step, 1e3 / host)
        for count, rate, step, host in zip(
            agents, rates[1 : 1 + sizes], rates[1 + sizes : 1 + 2 * sizes], rates[1 + 2 * sizes :], strict=True
        )
    ]
    return StackedBench(cases, device_name(torch.device(device)), stacks[0].block.recorded)


def full_stack(agents: int, device: str, hyper: Hyperparameters, simulator: Simulator = "device") -> StackedTraining:
    """A stack of seeds of the target task whose replays are full of random transitions."""
    members = [Member(TrainingConfig(seed=seed), NoRecorder(), NavigationExpert()) for seed in range(agents)]
    training = StackedTraining(members, device, hyperparameters=hyper, simulator=simulator)
    replay = training.stack.replay
    replay.rows.normal_()
    first = replay.features + SCALARS - 2
    replay.rows[..., first : first + 2] = (replay.rows[..., first : first + 1] > 3.1).float()
    replay.added[:] = replay.slots
    replay.stored.fill_(replay.slots)
    return training


def in_turns(turns: Sequence[Turn], rounds: int, slice_s: float, progress: Progress | None = None) -> list[float]:
    """Median work per second of each, taking turns; the first round only warms up."""
    rates: list[list[float]] = [[] for _ in turns]
    for number in range(rounds + 1):
        for found, turn in zip(rates, turns, strict=True):
            done, began, spent_s = 0, time.perf_counter(), 0.0
            while not done or (number and spent_s < slice_s):
                done += turn()
                spent_s = time.perf_counter() - began
            found.append(done / spent_s)
        if progress is not None:
            progress(number + 1, rounds + 1)
    return [float(np.median(found[1:])) for found in rates]


def _one_seed(hyper: Hyperparameters, stored: int) -> Turn:
    updates = our_updates(FastTd3, task_for(), hyper, stored)

    def turn() -> int:
        updates(UPDATES)
        return UPDATES

    return turn


def _updates(training: StackedTraining, hyper: Hyperparameters) -> Turn:
    def turn() -> int:
        blocks = max(1, UPDATES // hyper.updates_per_lane_step)
        for _ in range(blocks):
            training.block(())
        _wait_for(training.device)
        return blocks * hyper.updates_per_lane_step * len(training.agents)

    return turn


def _steps(stack: Stack, hyper: Hyperparameters) -> Turn:
    def turn() -> int:
        collect(stack, hyper)
        _wait_for(stack.learner.device)
        return 1

    return turn


def _wait_for(device: torch.device) -> None:
    if device.type == "cuda":
        torch.cuda.synchronize(device)
