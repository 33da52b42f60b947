"""Runs as tasks of a Ray cluster: the engine holds each run's lock, hands it to a node, and begins again what died."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import secrets
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from sim.errors import UsageError
from workbench import launcher
from workbench.cluster.brought_guide import guide_files
from workbench.cluster.ray_outcome import outcome_of, result_of
from workbench.cluster.receiver import RunReceiver
from workbench.cluster.run_agent import Order, train, versions_here
from workbench.engine_options import EngineOptions
from workbench.run_files import RunFileError, waiting_lock
from workbench.run_folder import LAUNCHER_LOCK, now
from workbench.runs import Run, RunBusyError, RunsFolderError, RunStore
from workbench.terminal import print_line

if TYPE_CHECKING:
    from agents.config import TrainingConfig

NAME: Final = "ray"
FAREWELL_S: Final = 10.0


@dataclass
class _Task:
    """A run that this engine looks after."""

    run: Run
    lock: int
    """Descriptor of the run's lock, held from the queue to the end."""
    attempt: int
    reference: Any


class RayEngine:
    """Runs of one command; they end with it, at their last checkpoint."""

    outlived = False

    def __init__(self, store: RunStore, options: EngineOptions) -> None:
        """Ray must be connected.

        Raises:
            UsageError: no node has as many cores or graphics cards as one run takes.
        """
        self._store = store
        self._options = options
        self._needs = {"CPU": options.cpus_per_run, "GPU": options.gpus_per_run}
        self._tasks: dict[str, _Task] = {}
        self._attempts = 0
        self._receiver: Any = None
        self._proof = ""
        if not self.at_once():
            raise UsageError(
                f"no node of this Ray has {options.cpus_per_run:g} cores and {options.gpus_per_run:g} graphics cards "
                "for a run; see --cpus-per-run and --gpus-per-run"
            )

    def at_once(self) -> int:
        """As many runs as cores and graphics cards of the living nodes hold."""
        import ray

        return sum(_fits(node["Resources"], self._needs) for node in ray.nodes() if node["Alive"])

    def free(self) -> int:
        """Room that no run of this engine has."""
        return max(self.at_once() - len(self._tasks), 0)

    def launch(self, config: TrainingConfig) -> Run:
        """A new run, handed to Ray, which starts it when there is room.

        Raises:
            RunsFolderError: the runs folder cannot be written.
        """
        run = self._store.create(config, engine=NAME)
        self._take(run)
        return run

    def resume(self, run: Run) -> Run:
        """Let a run go on from its last checkpoint, wherever it worked before.

        Raises:
            RunBusyError: it is finished, waits already, or is alive.
            RunFileError: its folder is damaged or cannot be written.
        """
        if run.problem:
            raise RunFileError(f"run {run.id} cannot be resumed: {run.problem}")
        try:
            with waiting_lock(self._store.root / LAUNCHER_LOCK):
                run.requeue(NAME)
                self._take(run)
        except OSError as error:
            raise RunsFolderError(f"runs folder {self._store.root} cannot be written: {error.strerror}") from error
        return run

    def tick(self) -> None:
        """Notice what has ended, begin again what died, let go what was stopped before it began."""
        import ray

        # Others may wait in this folder's queue for processes of this machine.
        launcher.drain(self._store)
        waiting = [task.reference for task in self._tasks.values()]
        ended = set(ray.wait(waiting, num_returns=len(waiting), timeout=0)[0]) if waiting else set()
        for task in list(self._tasks.values()):
            if task.reference in ended:
                self._end(task)
            elif not task.run.state.active and not task.run.state.node:
                ray.cancel(task.reference, force=True)
                self._let_go(task)

    def each(self, function: Callable[..., Any], arguments: Sequence[Sequence[Any]]) -> Iterator[tuple[int, Any]]:
        """Each call as a task of its own, begun again elsewhere if its node dies."""
        import ray

        # A fresh process for each, as locally: nothing that a library keeps can change a result.
        plain: Any = ray.remote(max_calls=1, max_retries=self._options.retries)(function)
        task = plain.options(**self._placement())
        open_ = {task.remote(*values): number for number, values in enumerate(arguments)}
        try:
            while open_:
                for reference in ray.wait(list(open_), num_returns=1)[0]:
                    number = open_.pop(reference)
                    yield number, result_of(reference)
        finally:
            for reference in open_:
                ray.cancel(reference, force=True)

    def close(self) -> None:
        """End what still works; each run can go on from its last checkpoint."""
        import ray

        # A run that has just ended: its node still has a folder to remove.
        if over := [task.reference for task in self._tasks.values() if not task.run.state.active]:
            ray.wait(over, num_returns=len(over), timeout=FAREWELL_S)
        for task in list(self._tasks.values()):
            with contextlib.suppress(Exception):  # the cluster may be gone
                ray.get(self._receiver.expect.remote(task.run.id, 0), timeout=5)
                ray.cancel(task.reference, force=True)
            self._let_go(task)
        if self._proof:
            (self._store.root / self._proof).unlink(missing_ok=True)

    def _take(self, run: Run) -> None:
        lock = run.claim()
        if lock is None:
            raise RunBusyError(f"run {run.id} is already being trained by another process")
        try:
            self._tasks[run.id] = _Task(run, lock, 0, None)
            self._hand_over(self._tasks[run.id])
        except BaseException:
            self._tasks.pop(run.id, None)
            os.close(lock)
            raise

    def _hand_over(self, task: _Task) -> None:
        """Ask Ray for a node for the next attempt at a run."""
        import ray

        self._attempts += 1
        task.attempt = self._attempts
        self._expect(task)
        order = Order(
            run=task.run.id, attempt=task.attempt, folder=str(task.run.path), folders=self._options.run_folders,
            proof=self._proof, entry=launcher.ENTRY, versions=versions_here(), guide=guide_files(task.run, self._store),
        )  # fmt: skip
        remote: Any = ray.remote(train)
        how = {"max_retries": 0, "name": f"run {task.run.id}"} | self._placement()
        task.reference = remote.options(**how).remote(self._receiver, order)

    def _expect(self, task: _Task) -> None:
        """Tell the receiver which attempt counts; one that died is replaced."""
        import ray
        from ray.exceptions import RayActorError

        try:
            if self._receiver is not None:
                ray.get(self._receiver.expect.remote(task.run.id, task.attempt))
                return
        except RayActorError:
            pass
        self._receiver = self._new_receiver()
        for each in self._tasks.values():
            ray.get(self._receiver.expect.remote(each.run.id, each.attempt))

    def _new_receiver(self) -> Any:
        import ray
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

        if not self._proof:
            self._proof = f".shared-{secrets.token_hex(8)}"
            (self._store.root / self._proof).touch()
        here = NodeAffinitySchedulingStrategy(ray.get_runtime_context().get_node_id(), soft=False)
        actor: Any = ray.remote(RunReceiver)
        return actor.options(num_cpus=0, scheduling_strategy=here).remote(str(self._store.root))

    def _placement(self) -> dict[str, Any]:
        return {"num_cpus": self._options.cpus_per_run, "num_gpus": self._options.gpus_per_run}

    def _end(self, task: _Task) -> None:
        """A task is over: its run has ended, or has to begin again."""
        outcome, reason = outcome_of(task.reference)
        state = task.run.state
        if outcome is not None and outcome.refused:
            self._fail(task, outcome.refused)
        elif not state.claimed or task.run.stop_requested():
            self._let_go(task)
        elif state.retries >= self._options.retries:
            self._fail(task, f"{reason}, {state.retries + 1} times, the last time on {state.node or 'no node'}")
        else:
            self._begin_again(task, reason)

    def _begin_again(self, task: _Task, reason: str) -> None:
        state = task.run.state
        again = f"{reason} on {state.node}; it begins again at its last checkpoint"
        print_line(f"workbench: run {task.run.id}: {again}", error=True)
        waiting = {"state": "queued", "beat_s": None, "node": "", "retries": state.retries + 1, "updated": now()}
        task.run.write_state(dataclasses.replace(state, **waiting))
        self._hand_over(task)

    def _fail(self, task: _Task, reason: str) -> None:
        failed = {"state": "failed", "error": reason, "eta_s": None, "updated": now()}
        task.run.write_state(dataclasses.replace(task.run.state, **failed))
        self._let_go(task)

    def _let_go(self, task: _Task) -> None:
        self._tasks.pop(task.run.id, None)
        os.close(task.lock)


def _fits(resources: dict[str, float], needs: dict[str, float]) -> int:
    """How many runs with these needs a node holds."""
    return min(int(resources.get(name, 0.0) / need + 1e-9) for name, need in needs.items() if need)
