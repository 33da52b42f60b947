"""`workbench bench`: how fast the simulator, the learner and the pages are on this machine."""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal

import tyro


@dataclass(frozen=True)
class Args:
    """Measure how fast this machine is: the simulator, the learner or the pages; each takes less than a minute."""

    what: Annotated[tyro.conf.Positional[Literal["sim", "learner", "page"]], tyro.conf.arg(metavar="WHAT")]
    """what to measure: sim (env-steps a second), learner (gradient steps a second), page (seconds to be there)."""
    device: str = ""
    """sim only: cpu or a graphics card such as cuda:0; empty for all there are."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Measure and print."""
    from workbench.progress import bar
    from workbench.terminal import print_json, print_line

    measure, show = {
        "sim": (partial(_sim, args.device), _show_sim),
        "learner": (_learner, _show_learner),
        "page": (_page, _show_page),
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
    from workbench.bench_growth import bench_growth
    from workbench.bench_sim import bench_sim

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


def _learner(progress: Any) -> dict[str, Any]:
    from workbench.bench_learner import bench_learner

    return dataclasses.asdict(bench_learner(progress=progress))


def _show_learner(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_table

    names = ("updates_per_s", "reference_updates_per_s", "sb3_updates_per_s")
    rows = [(f"{c['batch']}", c["device"], *(f"{c[name]:,.0f}" for name in names)) for c in figures["cases"]]
    rows.append(("256, profile fast", "cpu", f"{figures['fast_profile_updates_per_s']:,.0f}", "", ""))
    print_table(("batch", "device", "updates/s", "autograd", "Stable-Baselines3"), rows)


def _page(progress: Any) -> dict[str, Any]:
    from workbench.bench_page import bench_page

    return dataclasses.asdict(bench_page(progress=progress))


def _show_page(figures: dict[str, Any]) -> None:
    from workbench.terminal import print_table

    units = {"_s": "s", "_hz": "a second"}
    rows = []
    for name, value in figures.items():
        unit = next((words for end, words in units.items() if name.endswith(end)), "")
        rows.append((name.rpartition("_")[0].replace("_", " ") if unit else name.replace("_", " "),
                     "–" if value is None else f"{value:.4g} {unit}"))  # fmt: skip
    print_table(("what", "value"), rows)
