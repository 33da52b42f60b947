"""What grows, measured: seeds side by side, runs in a folder, what a run streams, what the head of a cluster bears.

The simulator's part, lanes and missiles, is `bench_growth`. Each figure takes seconds; all of them about a minute.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Final

from workbench.bench.growth import GrowthCase, bench_growth
from workbench.bench.runs import make_runs
from workbench.launcher import cpu_count

SEEDS: Final = (1, 2, 4)
SLICE_S: Final = 3.0
STORED: Final = 20_000
RUNS: Final = (100, 1_000, 4_000)
MESSAGE_S: Final = 1.0
PIECE_BYTES: Final = 4 * 2**20
ROW: Final = b'{"stage":0,"epoch":1,"success_rate":0.5}' + b" " * 560 + b"\n"
"""About what a row of metrics takes."""
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class SeedsCase:
    """So many trainings of the profile `fast` side by side, one process and one thread each."""

    seeds: int
    updates_per_s: float
    """Gradient steps a second of all of them together."""
    memory_mb: float
    """Resident memory of one of them [MB], with a replay of `STORED` transitions."""


@dataclass(frozen=True)
class RunsCase:
    """A folder with so many runs."""

    runs: int
    first_look_s: float
    """Until the index knows all of them."""
    next_look_s: float
    """Until it knows that nothing has changed."""
    list_s: float
    """Until `workbench runs` has read every folder."""


@dataclass(frozen=True)
class HeadCase:
    """What the head of a cluster takes in, without the network between."""

    questions_per_s: float
    """A node asks whether its run is to stop."""
    rows_per_s: float
    """A row of metrics, on the disk itself."""
    mb_per_s: float
    """Checkpoints in pieces of 4 MB, on the disk itself."""


@dataclass(frozen=True)
class RunCost:
    """What a training of the profile `fast` is made of."""

    epochs: int
    """At most, in each stage."""
    updates_per_epoch: int
    checkpoint_mb_per_epoch: float
    """Experience of an epoch and the learner's state, as they are streamed [MB]."""
    replay_mb: float
    """Experience that a whole checkpoint holds at most [MB]."""


@dataclass(frozen=True)
class GrowthFigures:
    """What `workbench bench growth` prints."""

    steps: list[GrowthCase]
    memory_bytes_per_lane: float
    seeds: list[SeedsCase]
    runs: list[RunsCase]
    head: HeadCase
    cost: RunCost


def measure(progress: Progress | None = None) -> GrowthFigures:
    """Measure all of it."""
    told = progress or (lambda _done, _of: None)
    parts = len(SEEDS) + len(RUNS) + 2
    simulator = bench_growth(repeats=10)
    told(1, parts)
    seeds = []
    for count in SEEDS:
        seeds.append(_seeds(count))
        told(1 + len(seeds), parts)
    runs = []
    for count in RUNS:
        runs.append(_runs(count))
        told(1 + len(seeds) + len(runs), parts)
    head = _head()
    told(parts, parts)
    return GrowthFigures(simulator.growth, simulator.memory_bytes_per_lane, seeds, runs, head, _cost())


def _seeds(count: int) -> SeedsCase:
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        pool_ready = [pool.submit(os.getpid) for _ in range(count)]
        _ = [ready.result() for ready in pool_ready]
        # All begin when the slowest is ready, or some would have the machine for themselves.
        begin_at = time.time() + 8.0 + 2.0 * count / cpu_count()
        found = list(pool.map(updates_in_slice, [begin_at] * count))
    return SeedsCase(count, sum(rate for rate, _ in found), max(memory for _, memory in found))


def updates_in_slice(begin_at: float) -> tuple[float, float]:
    """Gradient steps a second of one process that begins at this time of day, and its memory [MB]."""
    import psutil

    from agents.hyperparameters import FAST
    from agents.numerics import prepare_torch
    from agents.td3_fast import FastTd3
    from sim.task import task_for
    from workbench.bench.learner import UPDATES, our_updates

    prepare_torch()
    updates = our_updates(FastTd3, task_for(), FAST, STORED)
    updates(UPDATES)
    time.sleep(max(begin_at - time.time(), 0.0))
    made, began = 0, time.perf_counter()
    while (spent_s := time.perf_counter() - began) < SLICE_S or not made:
        updates(UPDATES)
        made += UPDATES
    return made / spent_s, psutil.Process().memory_info().rss / 1e6


def _runs(count: int) -> RunsCase:
    from workbench.run_index.index import RunIndex
    from workbench.runs import RunStore

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "runs"
        make_runs(root, count)
        index = RunIndex(root)
        first_s, next_s = _timed(index.look), _timed(index.look)
        return RunsCase(count, first_s, next_s, _timed(RunStore(root).list))


def _timed(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def _head() -> HeadCase:
    from agents.config import TrainingConfig
    from workbench.cluster.receiver import RunReceiver
    from workbench.runs import RunStore

    with tempfile.TemporaryDirectory() as folder:
        run = RunStore(folder).create(TrainingConfig(), engine="ray")
        head, sizes = RunReceiver(folder), [0]
        head.expect(run.id, 1)

        def row() -> None:
            assert head.append(run.id, 1, "metrics.jsonl", sizes[0], ROW)
            sizes[0] += len(ROW)

        piece = os.urandom(PIECE_BYTES)
        part = "checkpoints/replay-000001-0.safetensors"
        return HeadCase(
            _rate(lambda: head.wishes(run.id, 1)),
            _rate(row),
            _rate(lambda: head.put(run.id, 1, part, 0, piece, True)) * PIECE_BYTES / 1e6,
        )


def _rate(work: Callable[[], object]) -> float:
    work()
    done, began = 0, time.perf_counter()
    while (spent_s := time.perf_counter() - began) < MESSAGE_S:
        work()
        done += 1
    return done / spent_s


def _cost() -> RunCost:
    from agents.evasion import EVASION
    from agents.hyperparameters import FAST
    from agents.replay import Replay
    from sim.task import task_for

    features = EVASION.features(task_for().layout).size
    row_bytes = 4 * Replay(FAST.lanes, FAST.lanes, features).rows.shape[1]
    (first, second), inputs = FAST.hidden, features + 1
    weights = inputs * first + first * second + 2 * second
    # Actor, its average, two critics with two outputs and their targets; Adam's two moments of what learns.
    state_bytes = 4 * weights * (2 + 4 + 2 * 3)
    return RunCost(
        epochs=FAST.epochs,
        updates_per_epoch=FAST.updates_per_lane_step * FAST.steps_per_epoch // FAST.lanes,
        checkpoint_mb_per_epoch=(row_bytes * FAST.steps_per_epoch + state_bytes) / 1e6,
        replay_mb=row_bytes * FAST.replay_size / 1e6,
    )
