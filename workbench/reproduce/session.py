"""The runner: trains what is missing, follows what trains already, evaluates what is trained, writes result sets."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench.engine import Engine, LocalEngine
from workbench.launcher import cpu_count
from workbench.reproduce.assembly import NOTHING_FLOWN, Flown, assemble
from workbench.reproduce.earlier import NOTHING_EARLIER, earlier
from workbench.reproduce.eta import left_s, training_s
from workbench.reproduce.job import BusyError, Job, JobFile, kind_of, working
from workbench.reproduce.matching import training_key
from workbench.reproduce.measurements import Measurements, known_figures
from workbench.reproduce.plan import Plan, training_of
from workbench.reproduce.provenance import provenance
from workbench.reproduce.result_file import save
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.trainings import Trainings
from workbench.reproduce.watch import Standing, Watch
from workbench.run_folder import now
from workbench.runs import RunStore

__all__ = ["BusyError", "Report", "Session"]

TICK_S = 0.5
Fly = Callable[[Callable[[str], None]], Flown]
"""Flies single engagements; it is handed who wants to hear how far it is."""


def nothing_to_fly(told: Callable[[str], None]) -> Flown:
    """For items that show no single engagement."""
    return NOTHING_FLOWN


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

    def __init__(
        self, plans: Sequence[Plan], store: RunStore, folder: Path, fly: Fly = nothing_to_fly,
        engine: Engine | None = None, finished_only: bool = False, add: bool = False,
    ) -> None:  # fmt: skip
        """Result sets go to `folder`; `fly` makes the engagements of Fig. 10 to 12, and tells how far it is.

        Trainings are the business of `engine`, by default of this machine's processes; with `finished_only` none is
        started or waited for, and the result sets hold what is there. With `add` they keep the trainings they have,
        whoever made them, and only the others are looked for.

        Raises:
            SubMasError: the result sets cannot be added to.
        """
        self._engine = engine or LocalEngine(store)
        self._plans, self._store, self._folder, self._fly = plans, store, folder, fly
        self._flown = NOTHING_FLOWN
        self._origin = provenance()
        self._earlier = earlier(plans, folder, self._origin) if add else NOTHING_EARLIER
        self._trainings = Trainings(
            plans, store, self._engine, self._origin.scenario_digest, finished_only, self._earlier.keys
        )
        self._measurements = Measurements(plans, store.root, known_figures(folder, self._origin))

    def run(self, watch: Watch) -> Report:
        """Work until all is done or Ctrl-C; what is done by then is in the result sets either way.

        Raises:
            BusyError: another reproduction works with these runs.
            SubMasError: a folder cannot be written.
        """
        with working(self._store.root, kind_of([plan.item for plan in self._plans]), self._job()) as file:
            interrupted = self._work(watch, file)
            failed = [one.error for one in self._trainings.ended.values() if one.error]
            report = Report(self._write(), interrupted, (*failed, *self._measurements.failures.values()))
            file.end("interrupted" if interrupted else "failed" if report.failures else "finished")
        return report

    def _work(self, watch: Watch, file: JobFile) -> bool:
        """Work until all is done (False) or Ctrl-C (True)."""
        try:
            # Before the watch begins to draw: a terminal has one set of bars at a time.
            self._flown = self._fly(lambda words: file.update(doing=words))
            with watch:
                while self._round(watch, file):
                    time.sleep(TICK_S)
        except KeyboardInterrupt:
            farewell = self._farewell()
            watch.say(farewell)
            file.say(farewell)
            return True
        finally:
            self._measurements.stop()
        return False

    def _job(self) -> Job:
        items = tuple(plan.item for plan in self._plans)
        command = self._plans[0].command if len(items) == 1 else f"workbench reproduce {' + '.join(items)}"
        return Job(
            items=items, profile=self._plans[0].profile, command=command, results=str(self._folder), pid=os.getpid(),
            started=now(),
        )  # fmt: skip

    def _round(self, watch: Watch, file: JobFile) -> bool:
        """Bring everything a step further; whether anything is left to do."""
        news = self._trainings.round()
        ended = self._trainings.ended
        # While trainings need the cores one policy is flown at a time.
        news += self._measurements.round(ended, max(cpu_count() - self._trainings.busy(), 1))
        if news:
            self._write()
        standing = self._standing()
        watch.show(standing)
        file.update(doing=standing.summary, share=standing.share, running=tuple(run.id for run in standing.running))
        for line in news:
            watch.say(f"{line}; {standing.summary}")
            file.say(line)
        return not self._trainings.done or self._measurements.flying > 0 or bool(self._measurements.due(ended))

    def _write(self) -> dict[str, ResultSet]:
        results: dict[str, ResultSet] = {}
        ended = self._trainings.ended
        for plan in self._plans:
            measured = list(self._measurements.known(plan, ended))
            flown = self._flown if plan.item == "fig12" else NOTHING_FLOWN
            fresh = assemble(plan, self._origin, ended, measured, flown)
            results[plan.item] = self._earlier.added_to(plan, fresh)
            save(results[plan.item], self._folder / f"{plan.item}.json")
        return results

    def _standing(self) -> Standing:
        trainings, measurements = self._trainings, self._measurements
        running = list(trainings.alive.values())
        known = sum(len(list(measurements.known(plan, trainings.ended))) for plan in self._plans)
        wanted = sum(self._to_fly(plan) for plan in self._plans)
        earlier = self._store.list() if trainings.configs else []
        needs = [training_s(trainings.configs[key], earlier) for key in trainings.to_come]
        for run in running:
            state = run.state
            guess = training_s(run.config, earlier) * (1.0 - state.progress)
            needs.append(guess if state.eta_s is None else state.eta_s)
        # Side by side while no training needs the cores, else one after the other.
        side_by_side = 1 if needs else cpu_count()
        left = left_s(needs, self._engine.at_once(), (wanted - known) * measurements.typical_s / side_by_side)
        return Standing(len(trainings.ended), len(trainings.configs), known, wanted, left, running)

    def _to_fly(self, plan: Plan) -> int:
        """Evaluations of a plan, without those of trainings that this session leaves out or has no need of."""
        never = set(self._trainings.missing) - set(self._trainings.to_come)
        return sum(
            one.seed is None
            or training_key(training_of(one.variant, plan.profile, one.seed)) not in never | self._earlier.keys
            for one in plan.wanted
        )

    def _farewell(self) -> str:
        alive = list(self._trainings.alive.values())
        if not alive:
            return "interrupted; the same command goes on from here"
        runs = ", ".join(run.id for run in alive)
        if not self._engine.outlived:
            return f"interrupted; the same command lets {runs} go on from the last checkpoint"
        return (
            f"interrupted; {len(alive)} training{'s' * (len(alive) != 1)} go{'es' * (len(alive) == 1)} on in the "
            f"background ({runs}) and nothing new is started; the same command picks them up, 'workbench stop RUN' "
            "ends one"
        )
