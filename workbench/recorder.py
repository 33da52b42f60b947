"""What a training tells about itself, written into its run folder (implements `agents.submas.Recorder`)."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from sim.errors import SubMasError
from workbench.run_files import append_line
from workbench.run_folder import now
from workbench.run_state import RunState
from workbench.runs import Run

if TYPE_CHECKING:
    from agents.checkpoint import PolicyCard
    from agents.policy import NetworkPolicy

WATCHED = ("critic_loss", "actor_loss", "q_mean", "return_mean")
"""Figures whose first non-finite value means that learning has diverged."""


class DivergedError(SubMasError):
    """Learning produced a number that is not finite."""


class AskedToStop(Exception):
    """A stage was about to begin although the training was asked to stop."""


class RunRecorder:
    """Writes epochs, events and policies of one training; asked at every epoch end whether to stop.

    `interrupted` says whether the process was signalled; the run's stop file is looked at here.
    """

    def __init__(self, run: Run, state: RunState, interrupted: Callable[[], bool] = lambda: False) -> None:
        self.run = run
        self.state = state
        self.stopped = False
        self._interrupted = interrupted
        self._began_s = time.monotonic() - state.wall_s

    def epoch(self, row: Mapping[str, Any]) -> None:
        """Append one row of metrics and bring `state.json` up to date.

        Raises:
            DivergedError: a watched figure of the row is not finite (the row is kept, with nulls).
        """
        append_line(self.run.path / "metrics.jsonl", row)
        stage, stages = int(row["stage"]), int(row["stages"])
        self._write(
            stage=stage,
            stages=stages,
            task=str(row["task"]),
            progress=min((stage + row["epoch"] / row["epochs"]) / stages, 1.0),
            eta_s=_finite(row.get("eta_s")),
            best_success_rate=self._best(stage, _finite(row.get("success_rate"))),
        )
        for name in WATCHED:
            value = row.get(name)
            if value is not None and not math.isfinite(value):
                raise DivergedError(f"learning diverged: non-finite {name} at epoch {row['epoch']} of {row['task']}")

    def event(self, kind: str, text: str, **fields: object) -> None:
        """Append one event, stamped with the wall-clock time and the seconds since the run began.

        Raises:
            AskedToStop: a stage wants to start after somebody asked the training to stop.
        """
        if kind == "stage_started" and self.should_stop():
            raise AskedToStop
        stamp = {"time": now(), "wall_s": round(self._wall_s(), 3)}
        append_line(self.run.path / "events.jsonl", {**stamp, "kind": kind, "text": text, **fields})

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        """Save a stage's best policy under its task's name and as the policy of the run."""
        from agents.checkpoint import save_policy

        save_policy(self.run.path / "policies" / f"{card.task}.safetensors", policy, card)
        save_policy(self.run.path / "policy.safetensors", policy, card)

    def should_stop(self) -> bool:
        """Whether the training is to end now; true once, true for ever."""
        self.stopped = self.stopped or self._interrupted() or self.run.stop_requested()
        return self.stopped

    def end(self, state: str, error: str = "") -> None:
        """Write the event that says how the run ended, then its last state."""
        self.event(state, error or f"training {state}")
        progress = 1.0 if state == "finished" else self.state.progress
        self._write(state=state, error=error, eta_s=None, progress=progress)

    def _best(self, stage: int, success_rate: float | None) -> float | None:
        previous = self.state.best_success_rate if stage == self.state.stage else None
        rates = [rate for rate in (previous, success_rate) if rate is not None]
        return max(rates, default=None)

    def _wall_s(self) -> float:
        return time.monotonic() - self._began_s

    def _write(self, **changes: Any) -> None:
        self.state = dataclasses.replace(self.state, **changes, updated=now(), wall_s=round(self._wall_s(), 3))
        self.run.write_state(self.state)


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
