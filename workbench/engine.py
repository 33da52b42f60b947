"""Where trainings and studies work: an engine starts them and keeps them moving. `local` processes, or a Ray cluster.

Everything else (commands, reproductions, what is shown) is the same for both: a run is its folder, see `runs.py`.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any, Protocol

from workbench import launcher
from workbench.engine_options import EngineOptions
from workbench.runs import Run, RunStore

if TYPE_CHECKING:
    from agents.config import TrainingConfig


class Engine(Protocol):
    """Who starts runs and keeps them moving."""

    outlived: bool
    """Whether runs go on when the command that began them has ended."""

    def at_once(self) -> int:
        """How many runs can work side by side."""
        ...

    def free(self) -> int:
        """How many more could be started now."""
        ...

    def launch(self, config: TrainingConfig) -> Run:
        """A new run, started now or when there is room."""
        ...

    def resume(self, run: Run) -> Run:
        """Let a run go on from its last checkpoint.

        Raises:
            RunBusyError: it is finished, waits already, or is alive.
        """
        ...

    def tick(self) -> None:
        """Start what may start, notice what has ended; to be called again and again."""
        ...

    def each(self, function: Callable[..., Any], arguments: Sequence[Sequence[Any]]) -> Iterator[tuple[int, Any]]:
        """Call a function of a module with each of these, side by side; number and result of each as it ends."""
        ...


class LocalEngine:
    """Processes of this machine, as many at once as there are cores; they outlive whoever started them."""

    outlived = True

    def __init__(self, store: RunStore, workers: int | None = None) -> None:
        self._store = store
        self._workers = workers

    def at_once(self) -> int:
        """As many as there are cores."""
        return self._workers or launcher.cpu_count()

    def free(self) -> int:
        """Cores that no training of this runs folder, also of nobody's plan, works or waits for."""
        busy = sum(run.state.active and not run.state.engine for run in self._store.list() if not run.problem)
        return max(self.at_once() - busy, 0)

    def launch(self, config: TrainingConfig) -> Run:
        """See `launcher.launch`."""
        return launcher.launch(self._store, config)

    def resume(self, run: Run) -> Run:
        """See `launcher.resume`."""
        return launcher.resume(self._store, run)

    def tick(self) -> None:
        """See `launcher.drain`."""
        launcher.drain(self._store)

    def each(self, function: Callable[..., Any], arguments: Sequence[Sequence[Any]]) -> Iterator[tuple[int, Any]]:
        """Each call in a process of its own."""
        # Spawned, not forked: torch's threads do not survive a fork.
        with ProcessPoolExecutor(self.at_once(), mp_context=get_context("spawn"), max_tasks_per_child=1) as pool:
            futures: dict[Future[Any], int] = {
                pool.submit(function, *values): number for number, values in enumerate(arguments)
            }
            try:
                for future in as_completed(futures):
                    yield futures[future], future.result()
            finally:
                pool.shutdown(wait=False, cancel_futures=True)


@contextlib.contextmanager
def open_engine(options: EngineOptions, store: RunStore | None = None, workers: int | None = None) -> Iterator[Engine]:
    """The engine that is asked for, ready to work; what it started for itself is gone afterwards.

    Args:
        options: what the command line says.
        store: the folder of the runs; may be left out where only `each` is used.
        workers: local only: at most so many calls of `each` at once, instead of as many as there are cores.

    Raises:
        UsageError: an option that is not legal, or Ray is not installed.
        ClusterError: Ray cannot be started, or no cluster answers.
    """
    options.check()
    store = store or RunStore("runs")
    if options.engine == "local":
        yield LocalEngine(store, workers)
        return
    from workbench.cluster.ray_connection import connected
    from workbench.cluster.ray_engine import RayEngine

    with connected(options):
        engine = RayEngine(store, options)
        try:
            yield engine
        finally:
            engine.close()
