"""`workbench stop`: ask a training to end at its next epoch."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Args:
    """Ask a run to stop at the end of its epoch; its best policy is judged and kept. A queued run never starts.

    'workbench resume' lets it go on all the same; to only make room for a while, 'workbench pause' is quicker.
    """

    run: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="RUN")]
    """Id of the run; 'workbench runs' lists them."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    now: bool = False
    """End it at once, in the middle of the epoch."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Ask; does not wait for the end."""
    from workbench.launcher import stop_now
    from workbench.runs import RunStore
    from workbench.terminal import print_json, print_line

    run = RunStore(args.runs).get(args.run)
    run.request_stop()
    if args.now:
        stop_now(run)
    state = run.state.state
    if args.json:
        print_json({"id": run.id, "state": state, "stop_requested": True})
    else:
        print_line(f"run {run.id} is stopped" if state == "stopped" else f"run {run.id} stops at the end of its epoch")
    return 0
