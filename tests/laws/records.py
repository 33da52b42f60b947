"""The same engagements flown by the kernel and by the float64 reference, and what each leaves to be compared."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from agents.expert import DraggingExpert
from sim.reference import ReferenceWorld
from sim.scenario import Variation
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, changed

HALF_TURN = np.pi / 2
SEEN_AT_S = 60
"""When positions are compared."""
NEVER = -1
ALL_ROUND = {"heading_spread_rad": np.pi, "altitude_spread_m": 3e3, "speed_spread_m_s": 40.0}
HALFWAY = {"evader_x_low_m": -40e3, "evader_x_high_m": 0.0, "interceptor_x_low_m": 20e3, "interceptor_x_high_m": 60e3}
SCENARIOS = {
    "default": changed(load_scenario(), start=HALFWAY | ALL_ROUND | {"y_spread_m": 20e3}),
    "drill": changed(
        DRILL,
        start=ALL_ROUND | {"evader_x_high_m": 10e3},
        variation={spread.name: 0.1 for spread in dataclasses.fields(Variation)},
    ),
}
"""Worlds as they are, but both aircraft begin anywhere, at any heading, and near enough to be fired at soon.

In the drill, no shot is like another.
"""


@dataclass
class Record:
    """Fates, times of events in substeps (`NEVER` for none), rewards, and positions after a minute, of L lanes."""

    launched: NDArray[np.int64]
    ended: NDArray[np.int64]
    fate: NDArray[np.int32]
    """`[L, M]`."""
    over: NDArray[np.int64]
    outcome: NDArray[np.int32]
    killer: NDArray[np.int32]
    """`[L]`; `over` is when the lane ended."""
    reward: NDArray[np.float64]
    """`[L, M + 2]` by term, summed over the flight."""
    aircraft_m: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    """`[L, 2, 3]` after `SEEN_AT_S`."""
    missile_m: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    """`[L, M, 3]` after `SEEN_AT_S`; NaN for what does not fly then."""

    @classmethod
    def empty(cls, world: World | ReferenceWorld) -> Record:
        """Nothing flown yet."""
        missiles, lanes = world.task.scenario.launch.missiles, world.lanes
        never = np.full((lanes, missiles), NEVER)
        return cls(
            launched=never, ended=never.copy(), fate=np.zeros((lanes, missiles), np.int32),
            over=np.full(lanes, NEVER), outcome=np.zeros(lanes, np.int32), killer=np.zeros(lanes, np.int32),
            reward=np.zeros((lanes, missiles + 2)),
        )  # fmt: skip

    def lanes(self, chosen: NDArray | slice) -> Record:
        """Only some lanes."""
        return Record(**{f.name: getattr(self, f.name)[chosen] for f in dataclasses.fields(self)})


class TimedReference(ReferenceWorld):
    """The reference, noting in which substep missiles are fired and end, and lanes end."""

    def __init__(self, task: Task, lanes: int, seed: int) -> None:
        super().__init__(task, lanes, seed)
        self.record, self.clock = Record.empty(self), 0

    def _substep(self, command: NDArray, terms: NDArray) -> None:
        super()._substep(command, terms)
        self.clock += 1
        for noted, now in (
            (self.record.launched, self.fate != Fate.UNLAUNCHED),
            (self.record.ended, self.fate > Fate.FLYING),
            (self.record.over, self.outcome != Outcome.FLYING),
        ):
            noted[(noted == NEVER) & now] = self.clock


def fly_kernel(
    task: Task, turns: NDArray, seed: int, drags: NDArray[np.bool_] | None = None, episodes: NDArray | None = None
) -> Record:
    """Fly the kernel by turns `[K, L]` [rad]; where `drags [L]`, the dragging expert's are flown and written there."""
    world, expert = World(task, turns.shape[1], seed), DraggingExpert()
    world.reset(episodes=np.arange(world.lanes) if episodes is None else episodes)
    world.trace()
    record, substeps = Record.empty(world), task.scenario.rules.substeps
    for k, turn in enumerate(turns):
        if drags is not None:
            turn[drags] = expert.act(world.observation, task.layout)[drags, 0]
        fate, flying = world.fate, world.outcome == Outcome.FLYING
        record.reward += world.step(turn).reward_terms
        events = (world.fate != fate).any(axis=1) | (world.outcome != Outcome.FLYING)
        for lane in np.flatnonzero(flying & events):
            _note(record, lane, k * substeps, world.traced(lane), world.outcome[lane] != Outcome.FLYING)
        if k + 1 == SEEN_AT_S:
            _see(record, world)
        if k >= SEEN_AT_S and (world.outcome != Outcome.FLYING).all():
            break
    record.fate, record.outcome, record.killer = world.fate, world.outcome, world.killer
    return record


def fly_reference(task: Task, turns: NDArray, seed: int, nudged: tuple[int, NDArray] | None = None) -> Record:
    """Fly the reference by the same turns; or one `(episode, [L, 2, 3])` L times, its aircraft moved by so much [m]."""
    reference = TimedReference(task, turns.shape[1], seed)
    record = reference.record
    if nudged is not None:
        reference.reset(episodes=np.full(reference.lanes, nudged[0]))
        reference.aircraft.position += nudged[1]
    for k, turn in enumerate(turns):
        record.reward += reference.step(turn).reward_terms
        # Edges and the time limit end a lane at the end of a decision step.
        record.over[(record.over == NEVER) & (reference.outcome != Outcome.FLYING)] = reference.clock
        if k + 1 == SEEN_AT_S:
            record.aircraft_m = reference.aircraft.position.copy()
            flying = (reference.fate == Fate.FLYING)[..., None]
            record.missile_m = np.where(flying, reference.missile.position, np.nan)
        if k >= SEEN_AT_S and (reference.outcome != Outcome.FLYING).all():
            break
    record.fate, record.outcome, record.killer = reference.fate, reference.outcome, reference.killer
    return record


def hard_turns(steps: int, lanes: int, seed: int) -> NDArray[np.float32]:
    """Turns `[K, L]` [rad]: a third of the lanes draws a new one every second, the others hold each for seconds."""
    draw = np.random.default_rng(seed)
    white = draw.uniform(-HALF_TURN, HALF_TURN, (steps, lanes))
    held = np.empty_like(white)
    for lane in range(lanes):
        k = 0
        while k < steps:
            seconds = int(draw.integers(2, 12))
            held[k : k + seconds, lane] = draw.choice([-HALF_TURN, HALF_TURN, draw.uniform(-HALF_TURN, HALF_TURN)])
            k += seconds
    return np.where(np.arange(lanes) % 3 == 0, white, held).astype(np.float32)


def _note(record: Record, lane: int, before: int, rows: NDArray, over: bool) -> None:
    """Write down what the substeps `[n, 14 + 8 M]` of one decision step of a lane say."""
    fates = rows[:, 20::8]
    for noted, now in ((record.launched, fates != Fate.UNLAUNCHED), (record.ended, fates > Fate.FLYING)):
        new = (noted[lane] == NEVER) & now.any(axis=0)
        noted[lane, new] = before + 1 + now.argmax(axis=0)[new]
    if over:
        record.over[lane] = before + len(rows)


def _see(record: Record, world: World) -> None:
    """Positions of everything that still flies."""
    rows = np.full((world.lanes, 14 + 8 * world.fate.shape[1]), np.nan)
    for lane in np.flatnonzero(world.outcome == Outcome.FLYING):
        rows[lane] = world.traced(lane)[-1]
    record.aircraft_m = np.stack([rows[:, :3], rows[:, 7:10]], axis=1)
    missiles = rows[:, 14:].reshape(world.lanes, -1, 8)
    record.missile_m = np.where((world.fate == Fate.FLYING)[..., None], missiles[..., :3], np.nan)
