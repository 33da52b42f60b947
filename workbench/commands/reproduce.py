"""`workbench reproduce`: the paper's Table 4 and Fig. 8, 9, 12 and 13 again, with what is missing trained first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from workbench.engine_options import LOCAL, EngineOptions

if TYPE_CHECKING:
    from workbench.reproduce.assembly import Flown
    from workbench.reproduce.plan import Plan
    from workbench.reproduce.result_set import ResultSet
    from workbench.reproduce.seed_counts import SeedCounts
    from workbench.reproduce.session import Report

SEEDS_LIMIT = 100
EPISODES_LIMIT = 1_000_000


@dataclass(frozen=True)
class Args:
    """Reproduce the paper: train what is missing, evaluate it, write result sets and pictures, show ours beside theirs.

    What is trained already, or is being trained, is used. After Ctrl-C nothing new is started; trainings go on in the
    background, and the same command picks them up.
    """

    item: Annotated[
        tyro.conf.Positional[Literal["table4", "fig8", "fig9", "fig12", "fig13", "all"]], tyro.conf.arg(metavar="ITEM")
    ]
    """table4, fig8 (ablations), fig9 (baselines), fig12 and fig13 (the shipped policies; no training), or all."""
    profile: str = "fast"
    """Settings of the trainings: fast, paper (Table 2 exactly) or smoke (seconds, to try things out)."""
    seeds: int = 10
    """How many trainings of each algorithm: seeds 0 to N-1."""
    seeds_submas: int | None = None
    """How many of SubMas-RL (default: as --seeds)."""
    seeds_baselines: int | None = None
    """How many of each of TD3, SAC and PPO, which take longest (default: as --seeds)."""
    episodes: int = 1000
    """Episodes behind every number."""
    finished_only: bool = False
    """Train nothing: evaluate the trainings that have finished, and tell which are missing."""
    add: bool = False
    """Keep the trainings that the result sets hold, from whatever machine, and train and evaluate only the others."""
    where: Annotated[EngineOptions, tyro.conf.arg(name="")] = LOCAL
    """Where trainings work; what is trained is evaluated on this machine."""
    out: Path | None = None
    """Folder of the result sets (default: assets/results in a checkout, else results in the folder of the runs)."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Carry out the plan, draw, and show; returns 1 if something failed and 130 after Ctrl-C."""
    from workbench.engine import open_engine
    from workbench.reproduce.session import Session, nothing_to_fly
    from workbench.reproduce.watch import Watch
    from workbench.runs import RunStore

    plans = plans_of(args)
    folder = results_folder(args) / args.profile
    fly = _fly if any(plan.item == "fig12" for plan in plans) else nothing_to_fly
    store = RunStore(args.runs)
    with open_engine(args.where, store) as engine:
        report = Session(plans, store, folder, fly, engine, args.finished_only, args.add).run(Watch())
    files = written(report.results, folder)
    if args.json:
        _print_json(report, files)
    else:
        _show(report, files)
    if report.interrupted:
        return 130
    return 1 if report.failures else 0


def _fly(told: Callable[[str], None]) -> Flown:
    """The engagements of Fig. 10 to 12."""
    from workbench.progress import bar
    from workbench.reproduce.assembly import Flown
    from workbench.reproduce.azimuth_flights import MOST_EPISODES, shared_flights
    from workbench.reproduce.replays import shared_replays

    with bar("an engagement that both policies win", "tried") as progress:

        def hear(tried: int) -> None:
            progress(tried, MOST_EPISODES)
            told(f"an engagement that both policies win: {tried} tried, of at most {MOST_EPISODES}")

        return Flown(shared_flights(hear), shared_replays(hear))


def plans_of(args: Args) -> list[Plan]:
    """The plans of what is asked for.

    Raises:
        UsageError: a number that is not legal, an unknown profile, or an engine's option that is not legal.
    """
    from sim.errors import UsageError
    from workbench.reproduce.plan import make_plan
    from workbench.reproduce.protocol import ITEMS

    args.where.check()
    if not 1 <= args.episodes <= EPISODES_LIMIT:
        raise UsageError(f"--episodes is {args.episodes}; legal are 1 to {EPISODES_LIMIT}")
    items = ITEMS if args.item == "all" else (args.item,)
    return [make_plan(item, args.profile, _seed_counts(args), args.episodes) for item in items]


def _seed_counts(args: Args) -> SeedCounts:
    from sim.errors import UsageError
    from workbench.reproduce.seed_counts import SeedCounts

    given = {"--seeds": args.seeds, "--seeds-submas": args.seeds_submas, "--seeds-baselines": args.seeds_baselines}
    for option, count in given.items():
        if count is not None and not 1 <= count <= SEEDS_LIMIT:
            raise UsageError(
                f"{option} is {count}; legal are 1 to {SEEDS_LIMIT}, the number of trainings of each algorithm"
            )
    return SeedCounts(*(args.seeds if count is None else count for count in given.values()))


def results_folder(args: Args) -> Path:
    """Where result sets go; those of the smoke profile say nothing and are never put beside the committed ones."""
    from workbench.reproduce.places import committed_results

    beside = None if args.profile == "smoke" else committed_results()
    return args.out or beside or args.runs / "results"


def written(results: Mapping[str, ResultSet], folder: Path) -> dict[str, list[Path]]:
    """Draw the pictures and write the document; files by item."""
    from workbench.reproduce.document import refresh, report
    from workbench.reproduce.pictures import draw
    from workbench.reproduce.places import committed_results, document
    from workbench.run_files import write_bytes

    files = {}
    for item, result in results.items():
        picture = folder / f"{item}.png"
        files[item] = [folder / f"{item}.json", *([picture] if draw(result, picture) else [])]
    if folder.parent == committed_results():
        refresh(document(), folder.parent)
    else:
        write_bytes(folder / "report.md", report(folder.parent, folder.name).encode())
    return files


def _print_json(report: Report, files: Mapping[str, Sequence[Path]]) -> None:
    from workbench.terminal import print_json

    print_json(
        {
            "items": {item: _summary(result, files[item]) for item, result in report.results.items()},
            "failures": list(report.failures),
            "interrupted": report.interrupted,
        }
    )


def _summary(result: ResultSet, files: Sequence[Path]) -> dict[str, Any]:
    from workbench.reproduce.points import POINTS, finding
    from workbench.reproduce.scorecard import complete

    points = []
    for point in POINTS[result.item]:
        verdict, here = finding(point, result) or (None, None)
        points.append({"says": point.says, "where": point.where, "here": here, "holds": verdict})
    return {
        "complete": complete(result),
        "files": [str(path) for path in files],
        "points": points,
        "numbers": len(result.numbers),
        "trainings": len(result.trainings),
        "left_out": list(result.left_out),
    }


def _show(report: Report, files: Mapping[str, Sequence[Path]]) -> None:
    from workbench.reproduce.scorecard import scorecard
    from workbench.terminal import print_line, print_table, print_warning

    for item, result in report.results.items():
        card = scorecard(result.item, result)
        print_line(card.title)
        print()
        for table in card.tables:
            print_table(table.columns, table.rows, title=table.title)
            print()
        for note in card.notes:
            print_line(note)
        print_line(f"written to {', '.join(str(path) for path in files[item])}")
        print()
    for sentence in report.failures:
        print_warning(sentence)
