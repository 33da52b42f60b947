"""What a training tells about itself, written into its run folder (implements `agents.submas.Recorder`)."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from agents.disk import sweep
from sim.errors import SubMasError
from workbench.checkpoints import Checkpoint, Checkpoints
from workbench.pulse import Pulse
from workbench.run_files import append_line, cut_back, signature
from workbench.run_folder import now
from workbench.run_state import RunState
from workbench.runs import Run

if TYPE_CHECKING:
    from agents.checkpoint import PolicyCard
    from agents.policy import NetworkPolicy
    from agents.snapshot import Snapshot

WATCHED = ("critic_loss", "actor_loss", "q_mean", "return_mean")
"""Figures whose first non-finite value means that learning has diverged."""


LINES = ("metrics.jsonl", "events.jsonl")
NOTHING_YET: Mapping[str, Any] = {"state": RunState("queued").to_json(), **dict.fromkeys(LINES, 0)}


class DivergedError(SubMasError):
    """Learning produced a number that is not finite."""


class AskedToStop(Exception):
    """A stage was about to begin although the training was asked to stop."""


class AskedToPause(Exception):
    """The training was asked to pause, and all that it goes on from is saved."""


class RunRecorder:
    """Writes epochs, events, policies and checkpoints of one training; asked at every epoch end whether to stop.

    `interrupted` says whether the process was signalled; the run's stop and pause files are looked at here.
    """

    def __init__(self, run: Run, state: RunState, interrupted: Callable[[], bool] = lambda: False) -> None:
        self.run = run
        self.state = state
        self.stopped = False
        self._interrupted = interrupted
        self._checkpoints = Checkpoints(run.path / "checkpoints", run.id)
        self._pulse = Pulse(time.monotonic())
        self._began_s = time.monotonic() - state.wall_s

    def resume(self) -> Snapshot | None:
        """Where to go on: metrics and events are cut back to there. None starts from the beginning.

        Raises:
            CheckpointError: there are checkpoints, and none is whole.
            RunFileError: the run's files cannot be brought back to it.
        """
        for folder in ("", "policies", "checkpoints"):
            sweep(self.run.path / folder)
        found = self._checkpoints.latest()
        facts = found.facts if found else NOTHING_YET
        for name in LINES:
            cut_back(self.run.path / name, int(facts[name]))
        self._go_on_from(facts["state"])
        if found:
            self.event("resumed", _resumed(found, self.state), checkpoint=found.number)
        elif self.state.resumes or self.state.retries:
            self.event("resumed", "begun anew: it had not saved a checkpoint yet")
        return found.snapshot if found else None

    def _go_on_from(self, before: Mapping[str, Any]) -> None:
        kept = {name: before[name] for name in ("stage", "stages", "task", "progress", "best_success_rate", "wall_s")}
        self.state = dataclasses.replace(self.state, **kept)
        self._began_s = time.monotonic() - self.state.wall_s

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
        self._write()

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        """Save a stage's best policy under its task's name and as the policy of the run."""
        from agents.checkpoint import save_policy

        save_policy(self.run.path / "policies" / f"{card.task}.safetensors", policy, card)
        save_policy(self.run.path / "policy.safetensors", policy, card)

    def checkpoint(self, take: Callable[[], Snapshot]) -> None:
        """Save what the training can be resumed from, if it is worth the time or is needed now.

        Raises:
            AskedToPause: somebody asked the training to pause; it is saved.
            DivergedError: a network's weight is not finite.
            RunFileError: it could not be saved. Training on without would be a promise broken in silence.
        """
        pausing = not self.should_stop() and self.run.pause_requested()
        if not (pausing or self.stopped or self._pulse.worth_saving(time.monotonic())):
            return
        began_s = time.monotonic()
        snapshot = take()
        _refuse_divergence(snapshot, self.state)
        sizes = {name: signature(self.run.path / name)[1] for name in LINES}
        self._checkpoints.save(snapshot, {"state": self.state.to_json(), "versions": versions(), **sizes})
        self._pulse.saved(time.monotonic() - began_s)
        if pausing:
            raise AskedToPause

    def should_stop(self) -> bool:
        """Whether the training is to end now; true once, true for ever."""
        self.stopped = self.stopped or self._interrupted() or self.run.stop_requested()
        return self.stopped

    def end(self, state: str, error: str = "") -> None:
        """Write the event that says how the run ended, then its last state."""
        self.event(state, error or f"training {state}")
        progress = 1.0 if state == "finished" else self.state.progress
        self._write(state=state, error=error, eta_s=None, progress=progress)
        if state == "finished":
            self._checkpoints.clear()

    def _best(self, stage: int, success_rate: float | None) -> float | None:
        previous = self.state.best_success_rate if stage == self.state.stage else None
        rates = [rate for rate in (previous, success_rate) if rate is not None]
        return max(rates, default=None)

    def _wall_s(self) -> float:
        return time.monotonic() - self._began_s

    def _write(self, **changes: Any) -> None:
        beat_s = time.monotonic()
        # On a cluster this clock is another machine's than that of who reads it.
        signs = {
            "patience_s": self._pulse.beat(beat_s),
            "beat_s": None if self.state.engine else beat_s,
            "updated": now(),
        }
        self.state = dataclasses.replace(self.state, **changes, **signs, wall_s=round(self._wall_s(), 3))
        self.run.write_state(self.state)


def versions() -> dict[str, str]:
    """Libraries whose version may change the bits of a training."""
    return {name: version(name) for name in ("numpy", "torch", "warp-lang")}


def _resumed(found: Checkpoint, state: RunState) -> str:
    """What the event says: where it goes on, what could not be used, and whether its bits may differ."""
    where = f" on {state.node}" if state.node else ""
    sentences = [f"resumed{where} at checkpoint {found.number}, {state.progress:.0%} done", *found.refused]
    before = found.facts["versions"]
    changed = [f"{name} {before.get(name)} is now {now}" for name, now in versions().items() if before.get(name) != now]
    if changed:
        sentences.append(f"{', '.join(changed)}, so what follows may differ from an uninterrupted training")
    return "; ".join(sentences)


def _refuse_divergence(snapshot: Snapshot, state: RunState) -> None:
    import numpy as np

    for name, array in snapshot.arrays.items():
        if name.startswith("learner/") and array.dtype.kind == "f" and not np.isfinite(array).all():
            raise DivergedError(f"learning diverged: non-finite {name.removeprefix('learner/')} in {state.task}")


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
