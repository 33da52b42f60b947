"""The process of several trainings that learn together: ``python -m workbench.stacked_training RUN_FOLDER…``.

Every run has its folder, recorder, lock and end of its own, as if it were trained by itself. It can be stopped or
paused by itself as well, and one that was interrupted is resumed by itself (`workbench.training`), from the last
checkpoint. SIGTERM or Ctrl-C stops those runs at once that were asked to stop before; where none was, all of them at
the end of their epoch, and at once on the second ask.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from types import FrameType

from agents.stacked.agent import Abandoned, Member
from workbench.launcher import drain
from workbench.policies import guide_for
from workbench.recorder import RunRecorder
from workbench.run_folder import now
from workbench.run_state import PATIENCE_S
from workbench.runs import Run, RunStore
from workbench.training import conclude


class Held:
    """One run of the process: its recorder, its lock, and how it ended."""

    def __init__(self, run: Run, lock: int) -> None:
        self.run, self.code = run, 0
        self.asked = self.at_once = self.over = False
        alive = {"state": "running", "pid": os.getpid(), "updated": now(), "beat_s": time.monotonic()}
        state = dataclasses.replace(run.state, **alive, patience_s=PATIENCE_S, error="")
        self.recorder = RunRecorder(run, dataclasses.replace(state, started=state.started or now()), lambda: self.asked)
        self._lock = lock

    def member(self, store: RunStore) -> Member:
        """The run as a part of the stack."""
        self.run.write_state(self.recorder.state)
        guide = guide_for(self.run.config, store)
        return Member(self.run.config, self.recorder, guide, self.end, lambda: self.at_once)

    def end(self, error: Exception | None) -> None:
        """Write how the run ended and let go of it; the others go on."""
        self.over = True
        try:
            if isinstance(error, Abandoned):
                self.recorder.end("stopped")
                self.code = 130
            elif error is not None:
                self.code = conclude(self.recorder, error)
            else:
                self.recorder.end("stopped" if self.recorder.stopped else "finished")
        finally:
            os.close(self._lock)


class Signals:
    """What SIGTERM and SIGINT mean to several runs."""

    def __init__(self, runs: Sequence[Held]) -> None:
        self._runs = runs

    def listen(self) -> None:
        """Handle the signals from now on."""
        signal.signal(signal.SIGTERM, self._handle)
        signal.signal(signal.SIGINT, self._handle)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        alive = [held for held in self._runs if not held.over]
        again = [held for held in alive if held.asked or held.run.stop_requested()]
        for held in again:
            held.at_once = True
        if not again:
            for held in alive:
                held.asked = True


def main(arguments: Sequence[str] | None = None) -> int:
    """Train what the run folders say, together; returns the exit code: that of the worst."""
    parser = argparse.ArgumentParser(prog="python -m workbench.stacked_training", description="Train runs together.")
    parser.add_argument("folders", type=Path, nargs="+", help="the run folders")
    parser.add_argument("--device", default="cpu", help="where networks are trained")
    parser.add_argument("--simulator", choices=("device", "host"), default="device", help="where worlds are flown")
    parser.add_argument("--locks", required=True, help="descriptors of the runs' locks, inherited from the launcher")
    options = parser.parse_args(arguments)
    locks = [int(number) for number in options.locks.split(",")]
    for lock in locks:
        os.set_inheritable(lock, False)
    store = RunStore(options.folders[0].absolute().parent)
    runs = [Held(Run(folder.absolute()), lock) for folder, lock in zip(options.folders, locks, strict=True)]
    Signals(runs).listen()
    try:
        _train(runs, store, options.device, options.simulator)
    finally:
        # From here on a signal may end the process: everything is written.
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        drain(store)
    return max(held.code for held in runs)


def _train(runs: Sequence[Held], store: RunStore, device: str, simulator: str) -> None:
    from agents.stacked.device import checked_device
    from agents.stacked.training import train_stacked

    try:
        members = [held.member(store) for held in runs]
        train_stacked(members, checked_device(device), simulator="host" if simulator == "host" else "device")
    except Exception as error:
        # What goes wrong for all of them (the device is full, say) ends all that still go on.
        for held in runs:
            if not held.over:
                held.end(error)


if __name__ == "__main__":
    sys.exit(main())
