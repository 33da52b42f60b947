"""How many environment steps a second the simulator makes here, and the NumPy reference at the same work.

Both start from the same states, taken from all phases of whole engagements, and take turns, so that whatever else the
machine does slows both. The kernel shares the lanes among threads; the reference has one.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from agents.expert import DraggingExpert
from agents.policy import Act, bind
from sim.errors import UsageError
from sim.reference import ReferenceWorld
from sim.scenario import Scenario
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Fate, Outcome, World

LANES = (1, 64, 1024, 4096)
THREADS = (1, 2)
ROUNDS = 4
KERNEL_S, REFERENCE_S = 0.2, 0.3
"""Shortest time that is measured in one round."""
FOUR_FLYING_STEPS = 20
"""Steps for which all four missiles certainly fly in the scenario that is made for it."""
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class SimCase:
    """One row of `workbench bench sim`."""

    work: str
    lanes: int
    threads: int
    device: str
    env_steps_per_s: float
    reference_env_steps_per_s: float


@dataclass(frozen=True)
class Work:
    """What is flown: a task, who flies, states to begin from, and how many steps from one of them."""

    name: str
    task: Task
    act: Act
    pool: dict[str, NDArray]
    """Arrays of the kernel's state; the leading axis is that of the states."""
    steps: int


def bench_sim(
    lanes: Sequence[int] = LANES,
    threads: Sequence[int] = THREADS,
    rounds: int = ROUNDS,
    seconds: tuple[float, float] = (KERNEL_S, REFERENCE_S),
    device: str = "",
    progress: Progress | None = None,
) -> list[SimCase]:
    """Measure every work with every number of lanes and of threads.

    Args:
        lanes: engagements stepped together.
        threads: threads that share the lanes on the CPU; more than there are groups of lanes are left out.
        rounds: kernel and reference take turns this often; each rate is the median.
        seconds: shortest time measured per round, of the kernel and of the reference.
        device: `cpu` or a graphics card such as `cuda:0`; empty for the CPU and all cards.
        progress: told how many cases of how many are done.

    Raises:
        UsageError: there is no such device.
    """
    devices = chosen_devices(device)
    works = [_dragging(), _four_flying()]
    plan = [(work, count) for work in works for count in lanes]
    cases: list[SimCase] = []
    for done, (work, count) in enumerate(plan):
        cases += _measure(work, count, threads, devices, rounds, seconds)
        if progress is not None:
            progress(done + 1, len(plan))
    return cases


def chosen_devices(device: str) -> list[str]:
    """The device asked for, or the CPU and every graphics card.

    Raises:
        UsageError: there is no such device; names those there are.
    """
    there = ["cpu", *_graphics_cards()]
    if device and device not in there:
        raise UsageError(f"there is no device '{device}'; here are {', '.join(there)}")
    return [device] if device else there


def _measure(
    work: Work, lanes: int, threads: Sequence[int], devices: list[str], rounds: int, seconds: tuple[float, float]
) -> list[SimCase]:
    worlds = {}
    for device in devices:
        for count in threads if device == "cpu" else (1,):
            world = World(work.task, lanes, device=device, threads=count)
            worlds[device, world.threads] = world
    rates: dict[tuple[str, int] | None, list[float]] = {kind: [] for kind in (*worlds, None)}
    for turn in range(rounds + 1):  # the first only warms up
        for kind, world in worlds.items():
            rates[kind].append(_rate(work, world, turn, seconds[0]))
        rates[None].append(_reference_rate(work, next(iter(worlds.values())), turn, seconds[1] if turn else 0.0))
    medians = {kind: float(np.median(found[1:])) for kind, found in rates.items()}
    return [SimCase(work.name, lanes, n, device, medians[device, n], medians[None]) for device, n in worlds]


def _rate(work: Work, world: World, turn: int, seconds: float) -> float:
    """Environment steps per second of a world, the policy's time included."""
    steps, spent_s, fresh = 0, 0.0, turn
    while spent_s < seconds or not steps:
        load(world, work, fresh)
        fresh += 1
        began = time.perf_counter()
        steps += _fly(world, work.act, work.steps)
        spent_s += time.perf_counter() - began
    return steps / spent_s


def _reference_rate(work: Work, world: World, turn: int, seconds: float) -> float:
    """The same from the same states, but one step from each: a stretch of the kernel's would take it too long."""
    steps, spent_s, fresh = 0, 0.0, turn
    while spent_s < seconds or not steps:
        load(world, work, fresh)
        reference = ReferenceWorld.taking_over(world)
        fresh += 1
        began = time.perf_counter()
        steps += _fly(reference, work.act, 1)
        spent_s += time.perf_counter() - began
    return steps / spent_s


def _fly(world: World | ReferenceWorld, act: Act, steps: int) -> int:
    """Fly lanes that start anew when they end, as training and evaluation do; environment steps made."""
    made, observation = 0, world.observation
    for _ in range(steps):
        step = world.step(act(observation))
        observation, over = step.observation, step.terminated | step.truncated
        made += world.lanes
        if over.any():
            observation = world.reset(lanes=over)
    return made


def load(world: World, work: Work, draw: int) -> None:
    """Put every lane into a state of the pool, spread over all of it, and fly one step so that it is observed."""
    size = len(work.pool["steps"])
    generator = np.random.default_rng(draw)
    # Each part of the pool gives its share, so that few lanes are not all drawn from one phase.
    chosen = ((np.arange(world.lanes) + generator.random()) * size / world.lanes).astype(int) % size
    world.restore({name: values[chosen] for name, values in work.pool.items()})
    world.step(np.zeros(world.lanes))
    over = world.outcome != Outcome.FLYING
    if over.any():
        world.reset(lanes=over)


def _dragging(engagements: int = 48, every: int = 16) -> Work:
    """The dragging expert on the target task: states at every 16th step of whole engagements."""
    task = Task(load_scenario())
    act, world = bind(DraggingExpert(), task), World(task, engagements)
    observation, parts = world.observation, []
    while (flying := world.outcome == Outcome.FLYING).any():
        if world.steps.max() % every == 0:
            parts.append({name: values[flying] for name, values in world.state().items()})
        observation = world.step(act(observation)).observation
    pool = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return Work("dragging expert, target task, whole engagements (policy included)", task, act, pool, steps=10)


def _four_flying(engagements: int = 64) -> Work:
    """Four missiles in flight all the time, the most there is to compute; given turns, no policy."""
    task = Task(four_missiles(load_scenario()))
    world = World(task, engagements)
    while not (world.fate == Fate.FLYING).all():
        world.step(np.zeros(engagements))
    turns: dict[int, NDArray] = {}

    def act(observation: NDArray) -> NDArray:
        lanes = len(observation)
        if lanes not in turns:
            turns[lanes] = np.random.default_rng(0).uniform(-0.5, 0.5, (lanes, 1)).astype(np.float32)
        return turns[lanes]

    return Work("four missiles in flight throughout", task, act, world.state(), FOUR_FLYING_STEPS)


def four_missiles(scenario: Scenario) -> Scenario:
    """A scenario in which four missiles fly after four steps, and none can end within half a minute."""
    everywhere = dataclasses.replace(
        scenario.launch, missiles=4, radar_range_m=1000e3, radar_half_angle_rad=np.pi, range_m=500e3,
        tail_fraction=1.0, spread=0.0, range_min_m=0.0, interval_s=1.0,
    )  # fmt: skip
    lasting = dataclasses.replace(scenario.missile, arm_s=30.0, speed_min_m_s=50.0, age_max_s=600.0)
    return dataclasses.replace(scenario, name="four-missiles", launch=everywhere, missile=lasting)


def _graphics_cards() -> list[str]:
    import warp as wp

    from sim.device import start_warp

    start_warp()
    return [device.alias for device in wp.get_cuda_devices()]
