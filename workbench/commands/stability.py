"""`workbench stability`: the target's stage again and again, each time without one remedy of the `fast` profile."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from workbench.engine_options import LOCAL, EngineOptions

if TYPE_CHECKING:
    from agents.trial import Trial
    from workbench.stability import Wish

SEEDS_LIMIT = 100
WORKERS_LIMIT = 256


@dataclass(frozen=True)
class Args:
    """Show what each remedy of the fast profile is good for: train without it, several seeds, and compare.

    Trials that the file holds are not trained again, so the same command goes on where it was interrupted.
    """

    remedies: Annotated[tuple[str, ...], tyro.conf.arg(metavar="[REMEDY ...]")] = ()
    """What to take away, see `agents/remedies.py`; all of them by default, and `none` for comparison."""
    seeds: int = 5
    """How many trials of each: seeds 0 to N-1."""
    at_once: int | None = None
    """How many are trained at once; by default as many as there are cores."""
    out: Path | None = None
    """File of the trials (default: assets/results/stability.jsonl in a checkout, else stability.jsonl)."""
    where: Annotated[EngineOptions, tyro.conf.arg(name="")] = LOCAL
    """Where the trials are trained."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Train what is missing, write file and picture, show the table; returns 130 after Ctrl-C."""
    from workbench.stability import COLUMNS, load, rows, save, wishes
    from workbench.terminal import print_json, print_line, print_table

    _check(args)
    path = args.out or _default_file()
    known = load(path)
    wanted = wishes(_chosen(args), range(args.seeds), known)
    interrupted = False
    try:
        for trial in _trained(args, wanted):
            known.append(trial)
            save(path, known)
    except KeyboardInterrupt:
        interrupted = True
    shown = [trial for trial in known if trial.remedy in _chosen(args)]
    files = _drawn(path, known)
    if args.json:
        print_json({"trials": [trial.to_json() for trial in shown], "files": files, "interrupted": interrupted})
    else:
        print_table(COLUMNS, rows(shown), title="The target task's stage, 40 epochs; success in percent")
        print_line(f"written to {', '.join(files)}" if files else "no trial yet")
    return 130 if interrupted else 0


def _check(args: Args) -> None:
    from agents.remedies import REMEDIES
    from sim.errors import UsageError

    for remedy in args.remedies:
        if remedy not in REMEDIES:
            raise UsageError(f"--remedies '{remedy}' is unknown; known are {', '.join(REMEDIES)}")
    if not 1 <= args.seeds <= SEEDS_LIMIT:
        raise UsageError(f"--seeds is {args.seeds}; legal are 1 to {SEEDS_LIMIT}, the number of trials of each")
    if args.at_once is not None and not 1 <= args.at_once <= WORKERS_LIMIT:
        raise UsageError(f"--at-once is {args.at_once}; legal are 1 to {WORKERS_LIMIT}")


def _chosen(args: Args) -> tuple[str, ...]:
    from agents.remedies import REMEDIES

    return tuple(dict.fromkeys(("none", *args.remedies))) if args.remedies else tuple(REMEDIES)


def _default_file() -> Path:
    from workbench.reproduce.places import committed_results

    results = committed_results()
    return results / "stability.jsonl" if results else Path("stability.jsonl")


def _trained(args: Args, wanted: list[Wish]) -> Iterator[Trial]:
    from workbench.engine import open_engine
    from workbench.progress import bar
    from workbench.stability import trials

    if not wanted:
        return
    with open_engine(args.where, workers=args.at_once) as engine, bar("trials", "trained") as progress:
        progress(0, len(wanted))
        for done, trial in enumerate(trials(wanted, engine), start=1):
            progress(done, len(wanted))
            progress.say(f"{trial.remedy}, seed {trial.seed}: fresh success {trial.final_success_rate:.1%}")
            yield trial


def _drawn(path: Path, known: list[Trial]) -> list[str]:
    from layouts.stability import Panel, picture
    from workbench.reproduce.places import ROOT
    from workbench.run_files import write_bytes
    from workbench.stability import panels, refresh

    if not known:
        return []
    drawing = path.with_suffix(".png")
    write_bytes(drawing, picture([Panel(*one) for one in panels(known)]))
    if path == _default_file():
        refresh(ROOT / "docs/stability.md", known)
    return [str(path), str(drawing)]
