"""`workbench resume`: let a training go on from its last checkpoint, and watch it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from workbench.engine_options import LOCAL, EngineOptions


@dataclass(frozen=True)
class Args:
    """Let a run that was paused, stopped, interrupted or failed go on from its last checkpoint, bit for bit.

    What it wrote after that checkpoint is made again. Ctrl-C asks it to stop at the end of the epoch.
    """

    run: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="RUN")]
    """Id of the run; 'workbench runs' lists them."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    where: Annotated[EngineOptions, tyro.conf.arg(name="")] = LOCAL
    """Where it goes on."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Resume the run and follow it to its end; 130 after Ctrl-C, 1 if it fails."""
    from workbench.commands.train import failures, report
    from workbench.engine import open_engine
    from workbench.follow import follow
    from workbench.runs import RunStore

    store = RunStore(args.runs)
    with open_engine(args.where, store) as engine:
        runs = [engine.resume(store.get(args.run))]
        interrupted = follow(engine, runs)
    report(runs, args.json)
    return 130 if interrupted else failures(runs)
