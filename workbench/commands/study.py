"""`workbench study`: maps of survival, over launch range and aspect or any two numbers of the scenario."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from workbench.engine_options import LOCAL, EngineOptions

if TYPE_CHECKING:
    from agents.envelope import Envelope

EPISODES_LIMIT = 100_000
THREADS_LIMIT = 256
SHOWN_ROWS = 13


@dataclass(frozen=True)
class Args:
    """Map where a policy survives: envelope flies it in every cell of two axes.

    By default one missile is fired at once at the evader from every range and side; give two numbers of the scenario,
    as in --x launch.range_m=20e3:60e3:9 --y missile.burn_s=4:12:9 --episodes 50, to fly whole engagements.
    """

    what: Annotated[tyro.conf.Positional[Literal["envelope"]], tyro.conf.arg(metavar="WHAT")]
    """what to map: envelope (survival over two axes)."""
    policy: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="POLICY")]
    """Who flies: a shipped name (submas-target, expert-dragging, ...), a run, or a path to a policy file."""
    x: str = "launch_range_m=5e3:60e3:200"
    """First axis, NAME=START:END:COUNT: launch_range_m, aspect_deg, aspect_rad, or section.key of the scenario."""
    y: str = "aspect_deg=-180:175:72"
    """Second axis; aspect is the shooter's angle off the evader's nose, left positive."""
    at: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """Hold something else at a value, NAME=VALUE, as in launch_range_m=20e3 or missile.cd0=0.5; may be repeated."""
    episodes: int = 1
    """Flights in each cell; more than one where something is random: the scenario's shots, sensor or starts."""
    seed: int = 0
    """Seed of what is random."""
    mask: str = ""
    """Masked missiles, as in 1,2; a shot is fired with the first that is not masked."""
    scenario: str = "default"
    """Scenario: a shipped name or a path to a scenario file."""
    threads: int | None = None
    """Threads of this machine; all cores by default. The result does not depend on it."""
    out: Annotated[tuple[Path, ...], tyro.conf.UseAppendAction] = ()
    """Write the map to this file: .json, .csv (a row per cell), .png or .svg; may be repeated."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    where: Annotated[EngineOptions, tyro.conf.arg(name="")] = LOCAL
    """Where it is flown."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Fly, show, and write the files that are asked for."""
    from workbench.study_files import check_study_file, write_study
    from workbench.terminal import print_json, print_line

    _check(args)
    for path in args.out:
        check_study_file(path)
    study = _fly(args)
    for path in args.out:
        write_study(study, path)
    if args.json:
        print_json(study.to_json() | {"files": [str(path) for path in args.out]})
    else:
        _show(study)
        for path in args.out:
            print_line(f"written to {path}")
    return 0


def _check(args: Args) -> None:
    from sim.errors import UsageError

    if not 1 <= args.episodes <= EPISODES_LIMIT:
        raise UsageError(f"--episodes is {args.episodes}; legal are 1 to {EPISODES_LIMIT}")
    if args.seed < 0:
        raise UsageError(f"--seed is {args.seed}; it must not be negative")
    if args.threads is not None and not 1 <= args.threads <= THREADS_LIMIT:
        raise UsageError(f"--threads is {args.threads}; legal are 1 to {THREADS_LIMIT}")
    args.where.check()


def _fly(args: Args) -> Envelope:
    from agents.envelope import envelope
    from agents.envelope_axis import parse_axis, parse_held
    from sim.task import task_for
    from workbench.engine import open_engine
    from workbench.policies import resolve_policy
    from workbench.progress import bar
    from workbench.runs import RunStore
    from workbench.study_bands import envelope_in_bands

    x, y, held = parse_axis(args.x), parse_axis(args.y), [parse_held(text) for text in args.at]
    task = task_for(args.scenario, args.mask)
    policy = resolve_policy(args.policy, RunStore(args.runs))
    how = {"held": held, "masked": task.masked, "episodes": args.episodes, "seed": args.seed}
    words = f"{policy.name}, {x.name} × {y.name}"
    if args.where.engine == "ray":
        with open_engine(args.where) as engine, bar(words, "flights") as progress:
            return envelope_in_bands(engine, policy, task.scenario, x, y, how, progress)
    threads = args.threads or len(os.sched_getaffinity(0))
    with bar(words, "flights") as progress:
        return envelope(policy, task.scenario, x, y, **how, threads=threads, progress=progress)


def _show(study: Envelope) -> None:
    from workbench.study_files import caption, title
    from workbench.terminal import percent, print_line, print_table

    print_line(f"{title(study)}: {percent(float(study.survived.mean()))} of all flights")
    for line in caption(study).split("\n"):
        print_line(line)
    print()
    boundaries = study.boundaries()
    print_table(*(_boundary_rows(boundaries) if boundaries else _share_rows(study)))


def _boundary_rows(boundaries: list[dict[str, float | None]]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    def kilometres(value: float | None) -> str:
        return "–" if value is None else f"{value / 1e3:.1f}"

    other, *limits = boundaries[0]
    chosen = boundaries[:: -(-len(boundaries) // SHOWN_ROWS)]
    rows = [(f"{row[other]:g}", *(kilometres(row[limit]) for limit in limits)) for row in chosen]
    return (other, "no escape from [km]", "to [km]", "last hit [km]"), rows


def _share_rows(study: Envelope) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    from workbench.terminal import percent

    every = -(-len(study.x.values) // SHOWN_ROWS), -(-len(study.y.values) // SHOWN_ROWS)
    columns = (f"{study.x.name} \\ {study.y.name}", *(f"{value:g}" for value in study.y.values[:: every[1]]))
    thinned = study.survived[:: every[0], :: every[1]]
    rows = [
        (f"{value:g}", *(percent(float(share)) for share in shares))
        for value, shares in zip(study.x.values[:: every[0]], thinned, strict=True)
    ]
    return columns, rows
