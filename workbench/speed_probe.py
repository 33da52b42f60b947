"""How fast this machine learns: ``python -m workbench.speed_probe PROFILE`` takes seconds and prints one JSON object.

It trains the target task for a fraction of an epoch, as a training would, and flies one held-out evaluation. The second
such fraction counts: the first one also loads kernels and warms caches up. Processor time is taken, not the clock's: a
training has a core to itself when its turn comes, whatever else runs now.
"""

from __future__ import annotations

import asyncio
import dataclasses
import json
import math
import sys
import time
from datetime import datetime
from typing import TYPE_CHECKING, Any

from sim.errors import SubMasError
from workbench.cache_folder import cache_folder
from workbench.estimate import Speed
from workbench.launcher import environment
from workbench.run_files import RunFileError, read_json, write_json

if TYPE_CHECKING:
    from agents.hyperparameters import Hyperparameters

FILE = "speeds.json"
LANE_STEPS = {"paper": 8, "fast": 24, "smoke": 16}
"""Steps of all lanes that are timed: a few seconds on one core."""
PATIENCE_S = 300.0


class ProbeError(SubMasError):
    """The speed of this machine could not be measured."""


def measure(profile: str) -> dict[str, float]:
    """Times of this profile's learner on the target task: `epoch_s` an epoch, `evaluation_s` an evaluation [s]."""
    import torch

    from agents.config import PROFILES, TrainingConfig
    from agents.expert import DraggingExpert
    from agents.recorder import NoRecorder
    from agents.submas import train

    class TwoRows(NoRecorder):
        """Keeps the rows and stops after the second."""

        def __init__(self) -> None:
            self.rows: list[dict[str, Any]] = []

        def epoch(self, row: dict[str, Any]) -> None:
            self.rows.append(row)

        def should_stop(self) -> bool:
            return len(self.rows) >= 2

    torch.set_num_threads(1)  # as a training process
    hyper = PROFILES[profile]
    recorder = TwoRows()
    # The dragging expert flies as long as a trained policy does, so lanes end and start as they will.
    train(TrainingConfig(), recorder, DraggingExpert(), hyperparameters=_fraction(hyper, LANE_STEPS[profile]))
    evaluation_s = _evaluation_s(hyper.evaluation_episodes)
    first, second = recorder.rows
    step_s = (second["cpu_s"] - first["cpu_s"]) / (second["env_steps"] - first["env_steps"])
    epoch_s = hyper.steps_per_epoch * step_s + evaluation_s / hyper.evaluate_every
    return {"epoch_s": epoch_s, "evaluation_s": evaluation_s}


def _fraction(hyper: Hyperparameters, lane_steps: int) -> Hyperparameters:
    # Learning begins with the first step: what has filled the replay of a real training would not be timed.
    return dataclasses.replace(
        hyper, epochs=3, evaluate_every=4, final_episodes=1, update_after=0, steps_per_epoch=lane_steps * hyper.lanes
    )


def _evaluation_s(episodes: int) -> float:
    from agents.evaluation import evaluate
    from sim.task import task_for
    from workbench.policies import resolve_policy

    policy, task = resolve_policy("submas-target"), task_for()
    began = time.process_time()
    evaluate(policy, task, episodes, 1)
    return time.process_time() - began


async def probe(profile: str) -> Speed:
    """Measure in a process of its own and remember what it says.

    Raises:
        ProbeError: the process failed or took too long.
    """
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "workbench.speed_probe", profile,
        stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE, env=environment(),
    )  # fmt: skip
    try:
        output, complaint = await asyncio.wait_for(process.communicate(), PATIENCE_S)
    except TimeoutError:
        raise ProbeError(f"measuring took longer than {PATIENCE_S:.0f} s and was given up") from None
    finally:
        if process.returncode is None:
            process.kill()
    if process.returncode != 0:
        last = (complaint.decode(errors="replace").strip().splitlines() or ["no reason given"])[-1]
        raise ProbeError(f"measuring failed: {last[:200]}")
    speed = Speed(float(json.loads(output)["epoch_s"]), "probe", when=f"{datetime.now():%d %b %Y, %H:%M}")
    remember(profile, speed)
    return speed


def remember(profile: str, speed: Speed) -> None:
    """Keep a measured speed for the pages of later days; a cache that cannot be written is done without."""
    known = {**_read(), profile: {"epoch_s": speed.epoch_s, "when": speed.when}}
    try:
        cache_folder().mkdir(parents=True, exist_ok=True)
        write_json(cache_folder() / FILE, known)
    except (OSError, RunFileError):
        return


def remembered() -> dict[str, Speed]:
    """Measured speeds by profile; what is damaged is left out."""
    speeds = {}
    for profile, value in _read().items():
        if profile in LANE_STEPS and isinstance(value, dict):
            epoch_s, when = value.get("epoch_s"), value.get("when")
            if isinstance(epoch_s, float) and math.isfinite(epoch_s) and epoch_s > 0.0 and isinstance(when, str):
                speeds[profile] = Speed(epoch_s, "probe", when=when[:40])
    return speeds


def _read() -> dict[str, Any]:
    try:
        return read_json(cache_folder() / FILE)
    except RunFileError:
        return {}


def main() -> int:
    """Measure the profile named on the command line."""
    if len(sys.argv) != 2 or sys.argv[1] not in LANE_STEPS:
        print(f"usage: python -m workbench.speed_probe {'|'.join(LANE_STEPS)}", file=sys.stderr)
        return 2
    print(json.dumps(measure(sys.argv[1])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
