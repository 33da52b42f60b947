"""`workbench pause`: save a training at the end of its epoch and end its process."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Args:
    """Ask a run to pause: after its epoch it is saved and its process ends. 'workbench resume' lets it go on."""

    run: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="RUN")]
    """Id of the run; 'workbench runs' lists them."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Ask; does not wait until it is saved."""
    from workbench.runs import RunStore
    from workbench.terminal import print_json, print_line

    run = RunStore(args.runs).get(args.run)
    run.request_pause()
    state = run.state.state
    if args.json:
        print_json({"id": run.id, "state": state, "pause_requested": True})
    else:
        print_line(f"run {run.id} is paused" if state == "paused" else f"run {run.id} pauses at the end of its epoch")
    return 0
