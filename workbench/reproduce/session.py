"""The runner: trains what is missing, follows what trains already, evaluates what is trained, writes result sets."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.errors import SubMasError
from workbench.launcher import cpu_count
from workbench.reproduce.assembly import assemble
from workbench.reproduce.eta import left_s, training_s
from workbench.reproduce.measurements import Measurements, known_figures
from workbench.reproduce.plan import Plan
from workbench.reproduce.provenance import provenance
from workbench.reproduce.result_file import save
from workbench.reproduce.result_set import Flight, ResultSet
from workbench.reproduce.trainings import Trainings
from workbench.reproduce.watch import Standing, Watch
from workbench.run_files import take_lock
from workbench.runs import RunsFolderError, RunStore

TICK_S = 0.5
LOCK = ".reproduce.lock"


class BusyError(SubMasError):
    """Two reproductions would train the same things twice."""


@dataclass(frozen=True)
class Report:
    """How a session went."""

    results: dict[str, ResultSet]
    """By item, as far as it has come."""
    interrupted: bool
    failures: tuple[str, ...]
    """What went wrong, a sentence each."""


class Session:
    """One call of `workbench reproduce`."""

    def __init__(self, plans: Sequence[Plan], store: RunStore, folder: Path, flights: Sequence[Flight] = ()) -> None:
        """Result sets go to `folder`; `flights` are those of Fig. 12."""
        self._plans, self._store, self._folder, self._flights = plans, store, folder, tuple(flights)
        self._origin = provenance()
        self._trainings = Trainings(plans, store, self._origin.scenario_digest)
        self._measurements = Measurements(plans, store.root, known_figures(folder, self._origin))

    def run(self, watch: Watch) -> Report:
        """Work until all is done or Ctrl-C; what is done by then is in the result sets either way.

        Raises:
            BusyError: another reproduction works with these runs.
            SubMasError: a folder cannot be written.
        """
        interrupted = False
        with self._alone(), watch:
            try:
                while self._round(watch):
                    time.sleep(TICK_S)
            except KeyboardInterrupt:
                interrupted = True
                watch.say(self._farewell())
            finally:
                self._measurements.stop()
        failed = [one.error for one in self._trainings.ended.values() if one.error]
        return Report(self._write(), interrupted, (*failed, *self._measurements.failures.values()))

    def _round(self, watch: Watch) -> bool:
        """Bring everything a step further; whether anything is left to do."""
        news = self._trainings.round()
        ended = self._trainings.ended
        # While trainings need the cores one policy is flown at a time.
        news += self._measurements.round(ended, max(cpu_count() - self._trainings.busy(), 1))
        if news:
            self._write()
        standing = self._standing()
        watch.show(standing)
        for line in news:
            watch.say(f"{line}; {standing.summary}")
        return not self._trainings.done or self._measurements.flying > 0 or bool(self._measurements.due(ended))

    def _write(self) -> dict[str, ResultSet]:
        results: dict[str, ResultSet] = {}
        ended = self._trainings.ended
        for plan in self._plans:
            measured = list(self._measurements.known(plan, ended))
            flights = self._flights if plan.item == "fig12" else ()
            results[plan.item] = assemble(plan, self._origin, ended, measured, flights)
            save(results[plan.item], self._folder / f"{plan.item}.json")
        return results

    def _standing(self) -> Standing:
        trainings, measurements = self._trainings, self._measurements
        running = list(trainings.alive.values())
        known = sum(len(list(measurements.known(plan, trainings.ended))) for plan in self._plans)
        wanted = sum(len(plan.wanted) for plan in self._plans)
        earlier = self._store.list() if trainings.configs else []
        needs = [training_s(trainings.configs[key], earlier) for key in trainings.missing]
        for run in running:
            state = run.state
            guess = training_s(run.config, earlier) * (1.0 - state.progress)
            needs.append(guess if state.eta_s is None else state.eta_s)
        # Side by side while no training needs the cores, else one after the other.
        side_by_side = 1 if needs else cpu_count()
        left = left_s(needs, cpu_count(), (wanted - known) * measurements.typical_s / side_by_side)
        return Standing(len(trainings.ended), len(trainings.configs), known, wanted, left, running)

    def _farewell(self) -> str:
        alive = list(self._trainings.alive.values())
        if not alive:
            return "interrupted; the same command goes on from here"
        runs = ", ".join(run.id for run in alive)
        return (
            f"interrupted; {len(alive)} training{'s' * (len(alive) != 1)} go{'es' * (len(alive) == 1)} on in the "
            f"background ({runs}) and nothing new is started; the same command picks them up, 'workbench stop RUN' "
            "ends one"
        )

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        """Hold the lock that keeps a second reproduction out of this runs folder; without trainings none is needed."""
        if not self._trainings.configs:
            yield
            return
        try:
            self._store.root.mkdir(parents=True, exist_ok=True)
            lock = take_lock(self._store.root / LOCK)
        except OSError as error:
            raise RunsFolderError(f"runs folder {self._store.root} cannot be written: {error.strerror}") from error
        if lock is None:
            raise BusyError(
                f"another reproduction works in {self._store.root}; wait for it, or choose other runs with --runs"
            )
        try:
            yield
        finally:
            os.close(lock)
