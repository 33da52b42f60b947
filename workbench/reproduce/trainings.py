"""The trainings of a reproduction: found in the runs folder, started where they are missing, followed to their end."""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Iterator, Sequence

from agents.config import TrainingConfig
from workbench.engine import Engine
from workbench.reproduce.assembly import Ended
from workbench.reproduce.matching import Key, matching_runs, training_key
from workbench.reproduce.plan import Plan
from workbench.reproduce.protocol import LABELS
from workbench.reproduce.provenance import file_digest
from workbench.reproduce.stage_curves import stage_records
from workbench.runs import Run, RunBusyError, RunStore

HALTED = ("interrupted", "paused", "stopped")


class Trainings:
    """Every training that some plans ask for, each once."""

    def __init__(
        self, plans: Sequence[Plan], store: RunStore, engine: Engine, scenario_digest: str, finished_only: bool = False,
        kept: Collection[Key] = (),
    ) -> None:  # fmt: skip
        """With `finished_only` those that have finished are found, and nothing is started or waited for.

        Those in `kept` are nobody's business here: an earlier result set has them.
        """
        configs = {training_key(config): config for plan in plans for config in plan.trainings}
        self.configs = {key: config for key, config in configs.items() if key not in kept}
        self.ended: dict[Key, Ended] = {}
        self.alive: dict[Key, Run] = {}
        """Queued or running."""
        self._store, self._engine = store, engine
        self._finished_only, self._looked = finished_only, False
        self._scenario_digest = scenario_digest
        self._halted: dict[Key, Run] = {}
        """Interrupted, paused or stopped: these go on where they were."""
        self._followed: dict[Key, str] = {}
        """Runs seen alive in this session: these are not started a second time, however they end."""

    @property
    def missing(self) -> list[Key]:
        """Those that have not ended and do not work."""
        return [key for key in self.configs if key not in self.ended and key not in self.alive]

    @property
    def to_come(self) -> list[Key]:
        """Those of them that this session will train."""
        return [] if self._finished_only else self.missing

    @property
    def done(self) -> bool:
        """Whether nothing more is to be expected."""
        return len(self.ended) == len(self.configs) or (self._finished_only and self._looked)

    def busy(self) -> int:
        """Trainings of this runs folder that work or wait, also those of nobody's plan."""
        return sum(run.state.active for run in self._good_runs()) if self.configs else 0

    def round(self) -> list[str]:
        """Look what has ended, start what may start; a line about each that ended since the last round."""
        if self.done:
            return []
        runs = matching_runs(self._store, self.missing + list(self.alive), self._scenario_digest)
        self._looked = True
        if self._finished_only:
            return list(self._settle(runs))
        self.alive = {key: run for key, run in runs.items() if run.state.active}
        self._followed |= {key: run.id for key, run in self.alive.items()}
        self._halted = {key: run for key, run in runs.items() if run.state.state in HALTED}
        news = list(self._settle(runs))
        self._start()
        return news

    def _settle(self, runs: dict[Key, Run]) -> Iterator[str]:
        for key in self.missing:
            run = runs.get(key)
            if run is not None and run.state.state == "finished":
                self.ended[key] = _finished(self.configs[key], run)
            elif key in self._followed:
                self.ended[key] = _failed(self.configs[key], run, self._followed[key])
            if key in self.ended and key in self._followed:
                yield self.ended[key].error or f"{words(self.configs[key])} is trained"

    def _start(self) -> None:
        """Start trainings while cores are free, no more: what others queue gets a turn, and Ctrl-C leaves no queue."""
        self._engine.tick()
        for key in self.missing[: self._engine.free()]:
            self.alive[key] = self._begin(key)
            self._followed[key] = self.alive[key].id

    def _begin(self, key: Key) -> Run:
        halted = self._halted.get(key)
        if halted is None:
            return self._engine.launch(self.configs[key])
        with contextlib.suppress(RunBusyError):  # somebody else was quicker
            self._engine.resume(halted)
        return halted

    def _good_runs(self) -> list[Run]:
        return [run for run in self._store.list() if not run.problem]


def words(config: TrainingConfig) -> str:
    """A training in a few words."""
    return f"{LABELS[config.variant]} seed {config.seed}"


def _finished(config: TrainingConfig, run: Run) -> Ended:
    files = sorted((run.path / "policies").glob("*.safetensors"))
    return Ended(
        variant=config.variant,
        seed=config.seed,
        state="finished",
        run=run.id,
        wall_s=run.state.wall_s,
        resumes=run.state.resumes + run.state.retries,
        stages=stage_records(run.metrics()),
        policies={path.stem: file_digest(path) for path in files},
    )


def _failed(config: TrainingConfig, run: Run | None, run_id: str) -> Ended:
    state = run.state if run else None
    reason = "its folder is gone" if state is None else state.error or f"its training is {state.state}"
    return Ended(
        variant=config.variant,
        seed=config.seed,
        state=state.state if state else "failed",
        run=run_id,
        wall_s=state.wall_s if state else 0.0,
        resumes=state.resumes + state.retries if state else 0,
        error=f"{words(config)}, run {run_id}: {reason}",
    )
