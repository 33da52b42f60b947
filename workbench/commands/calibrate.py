"""`workbench calibrate`: what a scenario must reproduce, whether it does, and a search for one that does."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

EPISODES_LIMIT = 1_000_000


@dataclass(frozen=True)
class Args:
    """Measure a scenario against the calibration targets (experts, ladder, flight lengths), or search for one."""

    scenario: str = "default"
    """Scenario: a shipped name or a path to a scenario file. A search takes from it what it does not choose."""
    episodes: int | None = None
    """Engagements per target; 1000 if not given. A search has its own numbers."""
    search: bool = False
    """Search for scenario parameters that meet the targets, and write them to --out."""
    seed: int | None = None
    """With --search: seed of the proposals; 0 if not given."""
    candidates: int | None = None
    """With --search: end after this many proposals; 200 if neither this nor --minutes is given."""
    minutes: float | None = None
    """With --search: end after this many minutes. Ctrl-C ends it as well; the best so far is always written."""
    out: Path | None = None
    """With --search: the scenario file to write (.toml)."""
    force: bool = False
    """With --search: replace the file if it exists."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Measure or search, and print; 1 when a target is missed."""
    _check(args)
    return _search(args) if args.search else _measure(args)


def _check(args: Args) -> None:
    from sim.errors import UsageError

    if args.episodes is not None and not 1 <= args.episodes <= EPISODES_LIMIT:
        raise UsageError(f"--episodes is {args.episodes}; legal are 1 to {EPISODES_LIMIT}")
    if args.seed is not None and args.seed < 0:
        raise UsageError(f"--seed is {args.seed}; it must not be negative")
    if args.search and args.episodes is not None:
        raise UsageError("--episodes does not go with --search, which measures the better the more thoroughly")
    if args.search and args.out is None:
        raise UsageError("--search needs a file to write; add --out and a name such as mine.toml")
    of_search = {name: getattr(args, name) for name in ("seed", "candidates", "minutes", "out", "force")}
    given = [f"--{name}" for name, value in of_search.items() if value is not None and value is not False]
    if given and not args.search:
        raise UsageError(f"{given[0]} belongs to a search; add --search")


def _measure(args: Args) -> int:
    from agents.calibration import calibrate
    from sim.scenario_file import load_scenario
    from workbench.progress import bar
    from workbench.terminal import print_json

    scenario = load_scenario(args.scenario)
    with bar(f"calibrating {scenario.name}", "flights") as progress:
        measured = calibrate(args.episodes or 1000, progress, scenario)
    if args.json:
        print_json(measured.to_json())
    else:
        _show(measured.to_json())
    return 0 if measured.ok else 1


def _search(args: Args) -> int:
    from workbench.cli import INTERRUPTED
    from workbench.progress import bar
    from workbench.scenario_search import Budget, Order, check_out, find, nothing_found, write
    from workbench.terminal import print_json, print_line

    assert args.out is not None
    check_out(args.out, args.force)
    order = Order(args.scenario, args.seed or 0, Budget.of(args.candidates, args.minutes), args.out)
    with bar("searching", "candidates" if args.minutes is None else "s") as progress:
        finding = find(order, progress)
    best = finding.best
    if best is None:
        raise KeyboardInterrupt if finding.interrupted else nothing_found(order)
    write(order, best)
    figures = best.calibration.to_json() | {"scenario": args.out.stem}
    if args.json:
        found = {"seed": order.seed, "tried": finding.tried, "candidate": best.number, "file": str(args.out)}
        print_json(figures | {"search": found | {"interrupted": finding.interrupted}})
    else:
        _show(figures)
        print()
        print_line(f"written to {args.out}; with fresh initial states: workbench calibrate --scenario {args.out}")
    if finding.interrupted:
        return INTERRUPTED
    return 0 if best.met else 1


def _show(figures: Mapping[str, Any]) -> None:
    from workbench.terminal import print_line, print_table

    targets = figures["targets"]
    title = f"scenario {figures['scenario']}: {figures['episodes']} engagements each, seed {figures['seed']}"
    print_table(("target", "value", "95 % interval", "accepted", "verdict"), [_row(t) for t in targets], title=title)
    for line in figures["left_out"]:
        print_line(f"left out: {line['name']} ({line['reason']})")
    met = sum(target["ok"] for target in targets)
    print()
    print_line(f"{met} of {len(targets)} targets met, shortfall {figures['shortfall']:.3g}")
    if any(target["verdict"] == "undecided" for target in targets):
        print("undecided: the interval reaches across a bound; more episodes narrow it")


def _row(target: Mapping[str, Any]) -> tuple[str, str, str, str, str]:
    verdict = {"ok": "ok", "not ok": "MISSED"}.get(target["verdict"])
    if verdict is None:
        verdict = "undecided, value ok" if target["ok"] else "undecided, value missed"
    return target["name"], _number(target["value"]), _interval(*target["ci95"]), _accepted(target), verdict


def _accepted(target: Mapping[str, Any]) -> str:
    return _number(target["low"]) if target["low"] == target["high"] else _interval(target["low"], target["high"])


def _interval(low: float, high: float) -> str:
    return "–" if math.isnan(low) or math.isnan(high) else f"{_number(low)} to {_number(high)}"


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.4g}"
