"""`workbench runs`: list, show and delete runs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

if TYPE_CHECKING:
    from workbench.runs import Run, RunStore


@dataclass(frozen=True)
class Args:
    """List all runs, show one, or move one to the trash."""

    action: Annotated[
        tyro.conf.Positional[Literal["list", "show", "delete"]], tyro.conf.arg(metavar="list|show|delete")
    ] = "list"
    """What to do."""
    run: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="RUN")] = ""
    """Id of the run to show or delete."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Do it."""
    from sim.errors import UsageError
    from workbench.runs import RunStore

    store = RunStore(args.runs)
    if args.action != "list" and not args.run:
        raise UsageError(f"'workbench runs {args.action}' needs a run id; 'workbench runs' lists them")
    if args.action == "list" and args.run:
        raise UsageError(f"'workbench runs list' takes no run; for one run: workbench runs show {args.run}")
    {"list": _list, "show": _show, "delete": _delete}[args.action](store, args)
    return 0


def facts(run: Run) -> dict[str, Any]:
    """One run as JSON: its state and configuration, or what is wrong with it."""
    if run.problem:
        return {"id": run.id, "state": "unreadable", "problem": run.problem}
    policy = run.policy_path()
    state = run.state.to_json()
    return {"id": run.id, **state, "config": run.config.to_json(), "policy": str(policy) if policy else None}


def _list(store: RunStore, args: Args) -> None:
    from workbench.policies import title
    from workbench.terminal import duration, percent, print_json, print_table

    runs = store.list()
    if args.json:
        print_json({"runs": [facts(run) for run in runs]})
        return
    rows = []
    for run in runs:
        if run.problem:
            rows.append((run.id, "unreadable", run.problem, "", "", ""))
            continue
        state = run.state
        figures = (f"{100 * state.progress:.0f} %", percent(state.best_success_rate), duration(state.wall_s))
        rows.append((run.id, state.state, title(run.config), *figures))
    if rows:
        print_table(("run", "state", "training", "progress", "success", "time"), rows)
    else:
        print(f"no runs in {store.root}; 'workbench train' makes one")


def _show(store: RunStore, args: Args) -> None:
    from workbench.stages import summarise
    from workbench.terminal import print_json, print_table

    run = store.get(args.run)
    found = facts(run)
    if args.json:
        stages = [] if run.problem else summarise(run.metrics())
        print_json({**found, "stages_learned": stages})
        return
    config = found.pop("config", {})
    rows = [(name, _cell(value)) for name, value in (found | config).items()]
    print_table(("field", "value"), rows)
    for event in [] if run.problem else run.events():
        print(f"{event.get('wall_s', 0):9.1f} s  {_cell(event.get('text'))}")


def _delete(store: RunStore, args: Args) -> None:
    from workbench.terminal import print_json

    target = store.delete(args.run)
    if args.json:
        print_json({"id": args.run, "moved_to": str(target)})
    else:
        print(f"run {args.run} is now {target}")


def _cell(value: object) -> str:
    from workbench.terminal import printable

    return printable("–" if value in (None, "") else str(value))
