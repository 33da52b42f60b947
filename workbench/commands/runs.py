"""`workbench runs`: list, show, delete and restore runs, and empty the trash."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

if TYPE_CHECKING:
    from workbench.runs import Run, RunStore


OF_ONE = ("show", "delete", "restore")
"""Actions on a single run."""


@dataclass(frozen=True)
class Args:
    """List all runs, show one, move one to the trash or back; only empty-trash removes any for good."""

    action: Annotated[
        tyro.conf.Positional[Literal["list", "show", "delete", "restore", "trash", "empty-trash"]],
        tyro.conf.arg(metavar="list|show|delete|restore|trash|empty-trash"),
    ] = "list"
    """What to do; trash lists the runs in the trash."""
    run: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="RUN")] = ""
    """Id of the run to show, delete or restore."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Do it."""
    from sim.errors import UsageError
    from workbench.runs import RunStore

    store = RunStore(args.runs)
    if args.action in OF_ONE and not args.run:
        raise UsageError(f"'workbench runs {args.action}' needs a run id; 'workbench runs' lists them")
    if args.action not in OF_ONE and args.run:
        raise UsageError(f"'workbench runs {args.action}' takes no run; for one run: workbench runs show {args.run}")
    {
        "list": _list, "show": _show, "delete": _delete, "restore": _restore, "trash": _trash, "empty-trash": _empty,
    }[args.action](store, args)  # fmt: skip
    return 0


def facts(run: Run) -> dict[str, Any]:
    """One run as JSON: its state and configuration, or what is wrong with it."""
    if run.problem:
        return {"id": run.id, "state": "unreadable", "problem": run.problem, **_written(run)}
    policy = run.policy_path()
    config = {"config": run.config.to_json(), "policy": str(policy) if policy else None}
    return {"id": run.id, **run.state.to_json(), **config, **_written(run)}


def _written(run: Run) -> dict[str, Any]:
    """What a person wrote about a run."""
    from workbench.run_notes import read_notes

    if not run.path.is_dir() or run.path.is_symlink():
        return {"notes": "", "tags": []}
    notes = read_notes(run.path)
    return {"notes": notes.text, "tags": list(notes.tags)}


def _list(store: RunStore, args: Args) -> None:
    _table(store.list(), args, f"no runs in {store.root}; 'workbench train' makes one")


def _trash(store: RunStore, args: Args) -> None:
    _table(store.trashed(), args, f"the trash of {store.root} is empty")


def _table(runs: list[Run], args: Args, nothing: str) -> None:
    from workbench.policies import title
    from workbench.terminal import duration, percent, print_json, print_line, print_table

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
        print_line(nothing)


def _show(store: RunStore, args: Args) -> None:
    from workbench.stages import summarise
    from workbench.terminal import print_json, print_line, print_table

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
        wall_s = event.get("wall_s")
        when = f"{wall_s:.1f}" if isinstance(wall_s, int | float) else "–"
        print_line(f"{when:>9} s  {_cell(event.get('text'))}")


def _delete(store: RunStore, args: Args) -> None:
    from workbench.terminal import print_json, print_line

    target = store.delete(args.run)
    if args.json:
        print_json({"id": args.run, "moved_to": str(target)})
    else:
        print_line(f"run {args.run} is now {target}; 'workbench runs restore {args.run}' brings it back")


def _restore(store: RunStore, args: Args) -> None:
    from workbench.terminal import print_json, print_line

    run = store.restore(args.run)
    if args.json:
        print_json({"id": run.id, "restored_to": str(run.path)})
    else:
        print_line(f"run {run.id} is back: {run.path}")


def _empty(store: RunStore, args: Args) -> None:
    from workbench.terminal import print_json, print_line

    removed = store.empty_trash()
    if args.json:
        print_json({"removed": removed})
    else:
        print_line(f"{removed} run{'s' * (removed != 1)} removed for good")


def _cell(value: object) -> str:
    from workbench.terminal import printable

    return printable("–" if value in (None, "") else str(value))
