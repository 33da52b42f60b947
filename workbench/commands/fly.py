"""`workbench fly`: one engagement, as a table, as JSON or as a file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

if TYPE_CHECKING:
    from sim.trajectory import Event, MissileTrack, Trajectory


@dataclass(frozen=True)
class Args:
    """Fly one engagement and show what happened; --out keeps it as a file."""

    policy: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="POLICY")]
    """Who flies: a shipped name (submas-target, expert-dragging, ...), a run, or a path to a policy file."""
    mask: str = ""
    """Masked missiles, as in 1,2; none is the target task."""
    seed: int = 0
    """Initial state: the same seed starts the same engagement for every policy and mask."""
    out: Path | None = None
    """Write the engagement to this file: .csv or .parquet (a row per instant), .rrd (Rerun), .acmi or .zip.acmi
    (Tacview), .png or .svg (a picture)."""
    scenario: str = "default"
    """Scenario: a shipped name or a path to a scenario file."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Fly, show, and write the file if one is asked for."""
    from agents.policy import bind
    from sim.errors import UsageError
    from sim.task import task_for
    from sim.trajectory import fly
    from workbench.exports import check_target, export
    from workbench.policies import resolve_policy
    from workbench.runs import RunStore
    from workbench.scenarios import trained_elsewhere
    from workbench.terminal import print_json, print_warning

    if args.seed < 0:
        raise UsageError(f"--seed is {args.seed}; it must not be negative")
    if args.out is not None:
        check_target(args.out)
    task = task_for(args.scenario, args.mask)
    policy = resolve_policy(args.policy, RunStore(args.runs))
    flight = fly(task, bind(policy, task), policy.name, args.seed)
    if args.out is not None:
        export(flight, args.out)
    warning = trained_elsewhere(policy, task)
    if args.json:
        print_json({**summary(flight, args.out), "warning": warning or None})
        return 0
    _show(flight, args.out)
    if warning:
        print_warning(warning)
    return 0


def summary(flight: Trajectory, out: Path | None = None) -> dict[str, Any]:
    """The engagement in one JSON object: result, missiles, events."""
    return {
        "policy": flight.policy,
        "mask": sorted(flight.task.masked),
        "missiles": list(flight.task.missiles),
        "scenario": flight.task.scenario.name,
        "scenario_digest": flight.task.scenario.digest,
        "seed": flight.seed,
        "outcome": flight.outcome.name.lower(),
        "success": flight.success,
        "killer": flight.killer or None,
        "return": flight.episode_return,
        "length_s": flight.duration_s,
        "missile_fates": [_fate(missile) for missile in flight.missiles],
        "events": [_event(event) for event in flight.events],
        "file": None if out is None else str(out),
    }


def _fate(missile: MissileTrack) -> dict[str, Any]:
    times = {"launch_s": missile.launch_s, "end_s": missile.end_s, "closest_m": missile.closest_m}
    return {"missile": missile.number, "fate": missile.fate.name.lower(), **times}


def _event(event: Event) -> dict[str, Any]:
    where = {"missile": event.missile or None, "distance_m": event.distance_m}
    return {"time_s": event.time_s, "kind": event.kind, **where, "text": event.text}


def _show(flight: Trajectory, out: Path | None) -> None:
    from workbench.scenarios import task_title
    from workbench.terminal import duration, print_table

    rows = [
        (f"{e.time_s:.1f}", e.text, "" if math.isnan(e.distance_m) else f"{e.distance_m:,.0f}") for e in flight.events
    ]
    title = f"{flight.policy} on {task_title(flight.task)}, seed {flight.seed}"
    print_table(("time [s]", "event", "distance [m]"), rows, title=title)
    outcome = flight.outcome.name.lower().replace("_", " ")
    print(f"\n{outcome}, return {flight.episode_return:.1f}, {duration(flight.duration_s)} min flown")
    if out is not None:
        print(f"written to {out}")
