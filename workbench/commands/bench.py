"""`workbench bench`: how fast the simulator, the learner and the pages are on this machine."""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from sim.errors import UsageError
from workbench.seeds import LIMIT


@dataclass(frozen=True)
class Args:
    """Measure how fast this machine is: the simulator, the learner, the pages, growth; a minute each, openings more."""

    what: Annotated[tyro.conf.Positional[Literal["sim", "learner", "page", "growth"]], tyro.conf.arg(metavar="WHAT")]
    """what to measure: sim (env-steps a second), learner (gradient steps a second), page (seconds to be there), growth
    (seeds, lanes, missiles, runs, and what a cluster would do; in a checkout it renews docs/growth.md)."""
    device: str = ""
    """cpu or a graphics card such as cuda:0. sim: empty for all there are. learner: adds agents stacked there."""
    curriculum: bool = False
    """learner only: train many seeds of the whole curriculum together on the device; time and success."""
    seeds: int = 10
    """With --curriculum: how many seeds, 0 to N - 1."""
    profile: str = "fast"
    """With --curriculum: settings, as for train."""
    simulator: Literal["device", "host"] = "device"
    """With --curriculum: where worlds are flown, as for train."""
    runs: Path = Path("runs")
    """With --curriculum: folder of the runs."""
    out: Path | None = None
    """With --curriculum: the file of the result (default: bench-curriculum-DEVICE.json)."""
    openings: int = 0
    """page only: open all pages in turn so many times instead, and say how much memory the server holds then."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Measure and print."""
    from workbench.progress import bar
    from workbench.terminal import print_json, print_line

    if args.curriculum:
        return _curriculum(args)
    measure, show = {
        "sim": (partial(_sim, args.device), _show_sim),
        "learner": (partial(_learner, args.device), _show_learner),
        "page": (partial(_page, args.openings), _show_page),
        "growth": (_growth, _show_growth),
    }[args.what]
    load = os.getloadavg()[0]
    with bar(f"measuring: {args.what}") as progress:
        figures = measure(progress)
    if args.json:
        print_json({**figures, "cores": os.cpu_count(), "load_before": load})
    else:
        show(figures)
        print()
        print_line(f"{os.cpu_count()} cores; load when it began: {load:.1f}")
    return 0


def _sim(device: str, progress: Any) -> dict[str, Any]:
    from workbench.bench.growth import bench_growth
    from workbench.bench.sim import bench_sim

    cases = [dataclasses.asdict(case) for case in bench_sim(device=device, progress=progress)]
    return {"cases": cases, **dataclasses.asdict(bench_growth(device or "cpu"))}


def _show_sim(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_line, print_table

    rows = [
        (c["work"], f"{c['lanes']}", f"{c['threads']}", c["device"], f"{c['env_steps_per_s']:,.0f}",
         f"{c['reference_env_steps_per_s']:,.0f}", f"{c['env_steps_per_s'] / c['reference_env_steps_per_s']:.0f} ×")
        for c in figures["cases"]
    ]  # fmt: skip
    print_table(("work", "lanes", "threads", "device", "env-steps/s", "NumPy reference", "ratio"), rows)
    print()
    growth = [
        (f"{c['lanes']}", f"{c['missiles_flying']}", f"{c['substeps']}", f"{c['step_us']:,.0f} µs",
         f"{1e3 * c['step_us'] / c['lanes']:,.0f} ns")
        for c in figures["growth"]
    ]  # fmt: skip
    print_table(("lanes", "missiles flying", "substeps", "one step", "per lane"), growth)
    print()
    print_line(f"memory: {figures['memory_bytes_per_lane']:,.0f} bytes a lane")
    print_line(f"one step of gymnasium.Env: {figures['gymnasium_step_us']:.0f} µs")


def _learner(device: str, progress: Any) -> dict[str, Any]:
    from workbench.bench.learner import bench_learner

    if not device:
        return dataclasses.asdict(bench_learner(progress=progress))
    from workbench.bench.stacked import bench_stacked

    together = bench_stacked(device, progress=progress)
    return dataclasses.asdict(bench_learner(progress=progress)) | dataclasses.asdict(together)


def _show_learner(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_line, print_table

    rows = [
        (f"{c['batch']}", c["device"], f"{c['updates_per_s']:,.0f}", _beside(c, "reference"), _beside(c, "sb3"))
        for c in figures["cases"]
    ]
    rows.append(("256, profile fast", "cpu", f"{figures['fast_profile_updates_per_s']:,.0f}", "", ""))
    print_table(("batch", "device", "updates/s", "autograd", "Stable-Baselines3"), rows)
    print_line(f"In brackets: with the learner's matrix products ({figures['matrix_products']}), not torch's own.")
    if "stacked" not in figures:
        return
    print()
    print_line(f"agents stacked on {figures['device_name']}, profile fast:")
    together = [
        (f"{c['agents']}", c["device"], f"{c['agent_updates_per_s']:,.0f}", f"{c['one_seed_updates_per_s']:,.0f}",
         f"{c['ratio']:.2f}", f"{c['collect_ms']:.1f} ms", f"{c['collect_host_ms']:.1f} ms")
        for c in figures["stacked"]
    ]  # fmt: skip
    heads = ("agents", "device", "updates/s of all", "one seed alone", "ratio", "one step of all lanes", "on the host")
    print_table(heads, together)


def _beside(case: dict[str, Any], other: str) -> str:
    """Another learner's rate, how many times faster ours is, and both with the same matrix products."""
    rates = case[f"{other}_updates_per_s"], case[f"{other}_same_products_updates_per_s"]
    own, same = (f"{rate:,.0f}, {case['updates_per_s'] / rate:.2f} ×" for rate in rates)
    return f"{own} ({same})"


def _curriculum(args: Args) -> int:
    from workbench.bench.curriculum import bench_curriculum, write_result
    from workbench.runs import RunStore
    from workbench.stack_options import StackOptions
    from workbench.terminal import print_json

    if args.what != "learner" or not 1 <= args.seeds <= LIMIT:
        raise UsageError(f"--curriculum is for 'bench learner', with --seeds from 1 to {LIMIT}")
    options = StackOptions(args.device or "cpu", stacked=True, simulator=args.simulator)
    result, interrupted = bench_curriculum(RunStore(args.runs), args.seeds, args.profile, options)
    path = args.out or Path(f"bench-curriculum-{options.device.replace(':', '')}.json")
    write_result(result, path)
    if args.json:
        print_json(result)
    else:
        _show_curriculum(result, path)
    failed = any(one["state"] == "failed" for one in result["runs"])
    return 130 if interrupted else int(failed)


def _show_curriculum(result: dict[str, Any], path: Path) -> None:
    from workbench.terminal import duration, percent, print_line, print_table

    rows = [
        (f"{one['seed']}", one["state"], percent(one["success_rate"]), duration(one["wall_s"]), f"{one['updates']:,}")
        for one in result["runs"]
    ]
    print_table(("seed", "state", "success", "time", "updates"), rows)
    print()
    print_line(
        f"{result['seeds']} seeds together on {result['device']}: {duration(result['wall_s'])}, "
        f"{percent(result['success_rate_mean'])} in the mean; {path}"
    )


def _page(openings: int, progress: Any) -> dict[str, Any]:
    from workbench.bench.openings import bench_openings
    from workbench.bench.page import bench_page

    if openings > 0:
        return dataclasses.asdict(bench_openings(openings, progress=progress))
    return dataclasses.asdict(bench_page(progress=progress))


def _show_page(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_table

    units = {"_s": "s", "_hz": "a second", "_mib": "MiB"}
    rows = []
    for name, value in figures.items():
        unit = next((words for end, words in units.items() if name.endswith(end)), "")
        rows.append((name.rpartition("_")[0].replace("_", " ") if unit else name.replace("_", " "),
                     "–" if value is None else f"{value:.4g} {unit}"))  # fmt: skip
    print_table(("what", "value"), rows)


def _growth(progress: Any) -> dict[str, Any]:
    from workbench.growth import measure
    from workbench.growth_page import markdown, refresh
    from workbench.launcher import cpu_count
    from workbench.reproduce.places import ROOT

    load = os.getloadavg()[0]
    figures = measure(progress)
    text = markdown(figures, cpu_count(), load)
    written = refresh(ROOT / "docs/growth.md", text)
    return {**dataclasses.asdict(figures), "markdown": text, "document": "docs/growth.md" if written else ""}


def _show_growth(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_line

    for line in figures["markdown"].split("\n"):
        print_line(line)
    print()
    if figures["document"]:
        print_line(f"written to {figures['document']}")
