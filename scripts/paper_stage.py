#!/usr/bin/env python3
"""Keep what one stage with the paper's own settings has come to: `python scripts/paper_stage.py RUN`, its folder.

Copies the policy and its card to assets/paper-stage, with the learning curve as numbers and as a picture.
"""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path

from layouts.stage_sheet import picture
from workbench.reproduce.places import ROOT
from workbench.run_folder import Run

PLACE = ROOT / "assets/paper-stage"
COLUMNS = (
    "epoch", "env_steps", "updates", "success_rate", "return_mean", "train_success_rate", "alpha", "epsilon", "beta",
    "transfer_share", "guide_share", "critic_loss", "q_mean", "wall_s", "cpu_s",
)  # fmt: skip
"""Of the run's `metrics.jsonl`."""


def main(arguments: list[str]) -> int:
    """Copy and draw; returns the exit code."""
    run = Run(Path(arguments[0])) if len(arguments) == 1 else None
    if run is None or not (run.path / "policies/target.safetensors").is_file():
        print("usage: python scripts/paper_stage.py RUN, folder of a finished run of the target task", file=sys.stderr)
        return 2
    PLACE.mkdir(parents=True, exist_ok=True)
    for suffix in (".safetensors", ".json"):
        shutil.copyfile(run.path / f"policies/target{suffix}", PLACE / f"target{suffix}")
    rows = run.metrics()
    with (PLACE / "curve.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows([_figure(row.get(name)) for name in COLUMNS] for row in rows)
    card = json.loads((PLACE / "target.json").read_text("utf-8"))
    image = picture(
        f"The target task with the settings of the paper's Table 2, seed {run.config.seed}",
        f"Held-out success in {run.config.hyperparameters.evaluation_episodes} fresh episodes after each of "
        f"{len(rows)} epochs of 10 000 steps; what is kept is the policy with the best of them.",
        [row["success_rate"] for row in rows], [row["epsilon"] for row in rows], card["epoch"],
    )  # fmt: skip
    (PLACE / "curve.png").write_bytes(image)
    return 0


def _figure(value: object) -> object:
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else value


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
