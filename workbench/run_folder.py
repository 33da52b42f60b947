"""One run folder: what it says about its training, and whether that training lives.

`runs/<id>/` holds `config.json`, `state.json`, `metrics.jsonl`, `events.jsonl`, `policies/`, `policy.safetensors`,
`evaluations/`, `checkpoints/`, `log.txt`, `run.lock` (a flock held while the training process lives), and `stop` or
`pause` (their presence asks the training to do so).
"""

from __future__ import annotations

import contextlib
import dataclasses
import os
import re
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.errors import SubMasError
from workbench.run_files import (
    ABSENT,
    LineReader,
    RunFileError,
    Signature,
    is_locked,
    read_json,
    signature,
    take_lock,
    waiting_lock,
    write_bytes,
    write_json,
)
from workbench.run_state import RunState

if TYPE_CHECKING:
    from agents.config import TrainingConfig

RUN_ID = re.compile(r"[0-9]{8}-[0-9]{6}-[a-z0-9]{6}")
LAUNCHER_LOCK = ".launcher.lock"
END_AT_ONCE = b"now"
"""What the file `stop` holds when not even the epoch is to be ended."""


class RunBusyError(SubMasError):
    """The run is alive and what was asked needs it at rest."""


def is_run_id(text: str) -> bool:
    """Whether `text` looks like a run id, `YYYYMMDD-hhmmss-xxxxxx`; nothing else ever becomes a path."""
    return RUN_ID.fullmatch(text) is not None


class Run:
    """One run folder. Cheap to ask often: what is parsed is kept until its file changes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.id = path.name
        self.problem = ""
        """Why this run cannot be shown properly; empty for a good run."""
        self._config: TrainingConfig | None = None
        self._config_seen: Signature | None = None
        self._state = RunState("failed")
        self._state_seen: Signature | None = None

    @property
    def config(self) -> TrainingConfig:
        """What the run was asked to do.

        Raises:
            RunFileError: `config.json` is missing or damaged; `problem` then holds the same sentence.
        """
        seen = signature(self.path / "config.json")
        if self._config is None or seen != self._config_seen:
            from agents.config import TrainingConfig

            try:
                self._config = TrainingConfig.from_json(read_json(self.path / "config.json"))
            except RunFileError:
                raise
            except (SubMasError, TypeError, ValueError) as error:
                raise RunFileError(f"config.json is not a training configuration: {error}") from error
            self._config_seen = seen
        return self._config

    @property
    def state(self) -> RunState:
        """How the run stands now: what it last wrote, corrected by whether its process lives.

        Raises:
            RunFileError: `state.json` is missing or damaged.
        """
        written = self._written_state()
        if not written.claimed:
            return written
        if self.is_alive():
            silent = written.state == "running" and written.silent(time.monotonic())
            return dataclasses.replace(written, state="stalled") if silent else written
        # The lock was free after "running" was read, so the process is gone; it may have written its last
        # word in between.
        written = self._written_state()
        return dataclasses.replace(written, state="interrupted") if written.claimed else written

    def _written_state(self) -> RunState:
        seen = signature(self.path / "state.json")
        if seen != self._state_seen or seen == ABSENT:
            self._state = RunState.from_json(read_json(self.path / "state.json"))
            self._state_seen = seen
        return self._state

    def write_state(self, state: RunState) -> None:
        """Replace `state.json`; only whoever holds the run's lock may call this."""
        write_json(self.path / "state.json", state.to_json())

    def is_alive(self) -> bool:
        """Whether a living process holds this run."""
        return is_locked(self.path / "run.lock")

    def claim(self) -> int | None:
        """The descriptor of the run's lock, or None when the run is alive."""
        try:
            return take_lock(self.path / "run.lock")
        except OSError as error:
            raise RunFileError(f"run {self.id} cannot be locked: {error.strerror}") from error

    def signature(self) -> tuple[Signature, Signature, Signature, bool]:
        """Changes whenever something a page shows about this run has changed."""
        names = ("state.json", "metrics.jsonl", "events.jsonl")
        state, metrics, events = (signature(self.path / name) for name in names)
        return state, metrics, events, self.is_alive()

    def metrics(self, since: int = 0) -> list[dict[str, Any]]:
        """Rows of `metrics.jsonl` from row number `since` on, one per finished epoch."""
        return LineReader(self.path / "metrics.jsonl").read_new()[since:]

    def events(self, since: int = 0) -> list[dict[str, Any]]:
        """Rows of `events.jsonl` from row number `since` on: `time`, `kind`, `text`, fields."""
        return LineReader(self.path / "events.jsonl").read_new()[since:]

    def policy_path(self) -> Path | None:
        """The best policy of the latest stage, or None while there is none."""
        path = self.path / "policy.safetensors"
        return path if path.is_file() else None

    def policy_missiles(self) -> tuple[int, ...]:
        """Missiles the best policy was trained with; all of the run's task while its card cannot be read."""
        with contextlib.suppress(RunFileError):
            missiles = read_json(self.path / "policy.json").get("missiles")
            if isinstance(missiles, list) and all(isinstance(missile, int) for missile in missiles):
                return tuple(missiles)
        return self.config.subtasks

    def log_tail(self, lines: int = 20) -> str:
        """The end of what the training process printed."""
        with contextlib.suppress(OSError), (self.path / "log.txt").open("rb") as file:
            file.seek(max(0, file.seek(0, os.SEEK_END) - 16_384))
            return "\n".join(file.read().decode(errors="replace").splitlines()[-lines:])
        return ""

    def request_stop(self) -> None:
        """Ask the run to stop at the end of its epoch, with its best policy judged; a queued run is stopped at once.

        Raises:
            RunBusyError: the run has already ended.
        """
        self._request("stop", "stopped")

    def request_pause(self) -> None:
        """Ask the run to pause at the end of its epoch: it is saved and its process ends; a queued one waits no longer.

        Raises:
            RunBusyError: the run has already ended.
        """
        self._request("pause", "paused")

    def request_end(self) -> None:
        """Tell whoever looks after a cluster's run to end it at once, as `launcher.stop_now` does a process here."""
        write_bytes(self.path / "stop", END_AT_ONCE)

    def end_requested(self) -> bool:
        """Whether a cluster's run is to end at once."""
        with contextlib.suppress(OSError):
            return (self.path / "stop").read_bytes() == END_AT_ONCE
        return False

    def _request(self, wish: str, outcome: str) -> None:
        with waiting_lock(self.path.parent / LAUNCHER_LOCK):
            state = self.state
            if state.state == "queued":
                self.write_state(dataclasses.replace(state, state=outcome, updated=now()))
            elif state.active:
                (self.path / wish).touch()
            else:
                raise RunBusyError(f"run {self.id} is not running: it is {state.state}")

    def stop_requested(self) -> bool:
        """Whether somebody asked this run to stop."""
        return (self.path / "stop").exists()

    def pause_requested(self) -> bool:
        """Whether somebody asked this run to pause."""
        return (self.path / "pause").exists()

    def requeue(self, engine: str = "") -> None:
        """Put a run that ended before its end into an engine's queue; who calls this holds the launcher's lock.

        Raises:
            RunBusyError: it is finished, waits already, or is alive.
            RunFileError: it cannot be read or written.
        """
        lock = self.claim()
        if lock is None:
            raise RunBusyError(f"run {self.id} cannot be resumed: it is running")
        try:
            state = self._written_state()
            if state.claimed:  # we hold its lock, so its process is gone
                state = dataclasses.replace(state, state="interrupted")
            if not state.resumable:
                reason = "there is nothing left to train" if state.state == "finished" else f"it is {state.state}"
                raise RunBusyError(f"run {self.id} cannot be resumed: {reason}")
            for wish in ("stop", "pause"):
                (self.path / wish).unlink(missing_ok=True)
            anew = {"state": "queued", "pid": None, "beat_s": None, "engine": engine, "node": "", "retries": 0}
            self.write_state(dataclasses.replace(state, **anew, resumes=state.resumes + 1, updated=now()))
        except OSError as error:
            raise RunFileError(f"run {self.id} cannot be resumed: {error.strerror}") from error
        finally:
            os.close(lock)


def now() -> str:
    """The wall-clock time as ISO 8601 with the zone, to the microsecond."""
    return datetime.now().astimezone().isoformat(timespec="microseconds")


def problem_of(run: Run) -> str:
    """Why the run cannot be shown, or "". Never raises: one bad run must not hide the others."""
    if run.path.is_symlink():
        return "is a link, not a folder"
    if not run.path.is_dir():
        return "is a file, not a folder"
    try:
        _ = run.config, run.state
    except RunFileError as error:
        return str(error)
    return ""
