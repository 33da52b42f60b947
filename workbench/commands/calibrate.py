"""`workbench calibrate`: what the default scenario must reproduce, and whether it does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Args:
    """Measure the default scenario against its calibration targets (experts, ladder, flight lengths)."""

    episodes: int = 1000
    """Engagements per target."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Measure and print; 1 when a target is missed."""
    from agents.calibration import calibrate
    from sim.errors import UsageError
    from workbench.progress import bar
    from workbench.terminal import print_json, print_table

    if args.episodes < 1:
        raise UsageError(f"--episodes is {args.episodes}; it must be at least 1")
    with bar("calibrating", "measurements") as progress:
        targets = [target.to_json() for target in calibrate(args.episodes, progress)]
    if args.json:
        print_json({"targets": targets})
    else:
        rows = [_row(target) for target in targets]
        print_table(("target", "value", "accepted", "verdict"), rows)
    return 0 if all(target["ok"] for target in targets) else 1


def _row(target: Mapping[str, Any]) -> tuple[str, str, str, str]:
    accepted = f"{target['low']:.4g} to {target['high']:.4g}"
    return target["name"], f"{target['value']:.4g}", accepted, "ok" if target["ok"] else "MISSED"
