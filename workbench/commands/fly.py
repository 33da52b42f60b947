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
    """Write the engagement to this file: .html (a replay that opens without a server), .gif or .mp4 (an animation),
    .csv or .parquet (a row per instant), .rrd (Rerun), .acmi or .zip.acmi (Tacview), .png or .svg (a picture)."""
    against: str = ""
    """A second policy that flies from the same initial state, beside the first in an .html, .gif, .mp4 or .rrd."""
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
    from workbench.exports import check_target
    from workbench.policies import resolve_policy
    from workbench.runs import RunStore
    from workbench.scenarios import trained_elsewhere
    from workbench.terminal import print_json, print_line, print_warning

    if args.seed < 0:
        raise UsageError(f"--seed is {args.seed}; it must not be negative")
    if args.against and args.out is None:
        raise UsageError(f"--against {args.against} needs --out: the second flight is shown beside the first in a file")
    if args.out is not None:
        check_target(args.out, 2 if args.against else 1)
    task, store = task_for(args.scenario, args.mask), RunStore(args.runs)
    policies = [resolve_policy(spec, store) for spec in (args.policy, args.against) if spec]
    bound = [bind(policy, task) for policy in policies]
    flights = [fly(task, act, policy.name, args.seed) for policy, act in zip(policies, bound, strict=True)]
    if args.out is not None:
        _write(flights, args.out)
    warnings = [warning for policy in policies if (warning := trained_elsewhere(policy, task))]
    if args.json:
        print_json({**summary(flights[0], args.out), "warning": " ".join(warnings) or None})
        return 0
    for flight in flights:
        _show(flight)
    if args.out is not None:
        print_line(f"written to {args.out}")
    for warning in warnings:
        print_warning(warning)
    return 0


def _write(flights: list[Trajectory], out: Path) -> None:
    from workbench.exports import export
    from workbench.progress import bar

    with bar(f"writing {out.name}", "pictures") as progress:
        export(flights[0], out, *flights[1:], update=progress)


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


def _show(flight: Trajectory) -> None:
    from workbench.scenarios import task_title
    from workbench.terminal import duration, print_line, print_table

    rows = [
        (f"{e.time_s:.1f}", e.text, "" if math.isnan(e.distance_m) else f"{e.distance_m:,.0f}") for e in flight.events
    ]
    title = f"{flight.policy} on {task_title(flight.task)}, seed {flight.seed}"
    print_table(("time [s]", "event", "distance [m]"), rows, title=title)
    outcome = flight.outcome.name.lower().replace("_", " ")
    print()
    print_line(f"{outcome}, return {flight.episode_return:.1f}, {duration(flight.duration_s)} min flown")
