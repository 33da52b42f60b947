"""The process of one training: ``python -m workbench.training RUN_FOLDER``. It needs no page and no server.

It goes on from the run's last checkpoint, if there is one. It stops at the end of an epoch when the run's `stop` file
appears or a SIGTERM or Ctrl-C arrives, and at once on the second ask; `pause` saves and ends it after the epoch.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from sim.errors import ActionError, SubMasError
from workbench.launcher import drain
from workbench.recorder import AskedToPause, AskedToStop, RunRecorder
from workbench.run_files import RunFileError
from workbench.run_folder import now
from workbench.run_state import PATIENCE_S
from workbench.runs import Run, RunBusyError, RunStore

if TYPE_CHECKING:
    from agents.policy import Policy
    from agents.snapshot import Snapshot


BROUGHT_GUIDE = "guide.safetensors"
"""Name in a run folder of a guide that comes with it."""
ABANDONED = 75
"""Exit code of a training whose engine is gone: it ends as if it had been killed."""


class StopNow(BaseException):
    """The second ask to stop: leave the epoch where it is."""


class Signals:
    """Counts asks to stop by SIGTERM and SIGINT; the second raises StopNow where the program stands, once."""

    def __init__(self, run: Run) -> None:
        self.asked = False
        self._run, self._heard_enough = run, False

    def __call__(self) -> bool:
        """Whether a signal has asked the training to stop."""
        return self.asked

    def listen(self) -> None:
        """Handle the signals from now on."""
        signal.signal(signal.SIGTERM, self._handle)
        signal.signal(signal.SIGINT, self._handle)

    def close(self) -> None:
        """Nothing is interrupted from now on: what a training writes at its end is written whole."""
        self._heard_enough = True

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._heard_enough:
            return
        if self.asked or self._run.stop_requested():
            self.close()
            raise StopNow
        self.asked = True


def main(arguments: Sequence[str] | None = None) -> int:
    """Train what the run folder's `config.json` says; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m workbench.training", description="Train one run folder.")
    parser.add_argument("folder", type=Path, help="the run folder")
    parser.add_argument(
        "--lock", type=int, default=None, help="descriptor of the run's lock, inherited from the launcher"
    )
    parser.add_argument(
        "--held",
        action="store_true",
        help="a cluster's engine holds the lock, and standard input for as long as it lives",
    )
    options = parser.parse_args(arguments)
    folder = options.folder.absolute()
    store = RunStore(folder.parent)
    try:
        run = store.get(folder.name)
        if options.held:
            return _train_held(run, store)
        lock = _hold(run, options.lock)
    except SubMasError as error:
        print(f"workbench: {error}", file=sys.stderr)
        return error.exit_code
    try:
        return _train(run, store)
    finally:
        # From here on a signal may end the process: everything is written.
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        os.close(lock)
        drain(store)


def _train_held(run: Run, store: RunStore) -> int:
    """Train for an engine, which starts what comes next; without it nobody would know of this process."""
    threading.Thread(target=_end_with_standard_input, daemon=True).start()
    return _train(run, store)


def _end_with_standard_input() -> None:
    sys.stdin.buffer.read()
    os._exit(ABANDONED)


def _hold(run: Run, inherited: int | None) -> int:
    """The descriptor that keeps the run's lock: the launcher's, or one of our own.

    Raises:
        RunBusyError: another process trains this run, or it has been trained.
    """
    if inherited is not None:
        os.set_inheritable(inherited, False)
        return inherited
    lock = run.claim()
    if lock is None:
        raise RunBusyError(f"run {run.id} is already being trained by another process")
    if run.state.state != "queued":
        raise RunBusyError(f"run {run.id} is not waiting to be trained: it is {run.state.state}")
    return lock


def _train(run: Run, store: RunStore) -> int:
    signals = Signals(run)
    signals.listen()
    alive = {"state": "running", "updated": now()}
    if not run.state.engine:  # a cluster's process and clock may be another machine's
        alive |= {"pid": os.getpid(), "beat_s": time.monotonic()}
    state = dataclasses.replace(run.state, **alive, patience_s=PATIENCE_S, error="")
    recorder = RunRecorder(run, dataclasses.replace(state, started=state.started or now()), signals)
    try:
        try:
            run.write_state(recorder.state)
            _learn(run, store, recorder, recorder.resume())
        finally:
            signals.close()
    except StopNow:
        recorder.end("stopped")
        return 130
    except Exception as error:
        return conclude(recorder, error)
    recorder.end("stopped" if recorder.stopped else "finished")
    return 0


def _learn(run: Run, store: RunStore, recorder: RunRecorder, snapshot: Snapshot | None) -> None:
    import torch

    from agents.submas import train

    # One process per seed, one thread per process: small networks are slower with more.
    torch.set_num_threads(1)
    train(run.config, recorder, _guide(run, store), snapshot=snapshot)


def _guide(run: Run, store: RunStore) -> Policy:
    from agents.checkpoint import load_policy
    from workbench.policies import guide_for

    # An engine that trains on another machine brings the guide along; its path would mean nothing there.
    brought = run.path / BROUGHT_GUIDE
    return load_policy(brought) if brought.is_file() else guide_for(run.config, store)


def conclude(recorder: RunRecorder, error: Exception) -> int:
    """Write how a training ended that did not come to its end by itself; the exit code."""
    if isinstance(error, AskedToStop | AskedToPause):
        recorder.end("paused" if isinstance(error, AskedToPause) else "stopped")
        return 0
    traceback.print_exception(error)
    return _fail(recorder, _reason(recorder, error))


def _reason(recorder: RunRecorder, error: Exception) -> str:
    if isinstance(error, ActionError):
        return f"learning diverged in {recorder.state.task or 'the first epoch'}: {error}"
    if isinstance(error, OSError) and not isinstance(error, SubMasError):
        return f"cannot save: {error.strerror or error}"
    # The last resort of a process: whatever went wrong, the run must say so.
    return str(error) if isinstance(error, SubMasError) else f"{type(error).__name__}: {error}"


def _fail(recorder: RunRecorder, reason: str) -> int:
    try:
        recorder.end("failed", reason)
    except RunFileError as error:
        # Nothing can be written any more (a full disk): the log and the exit code have to say it.
        print(f"workbench: {error}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
