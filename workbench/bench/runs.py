"""Run folders that no training made: as many as one likes, in little time, to see how pages bear thousands."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, Final

VARIANTS: Final = ("submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr", "td3", "sac", "ppo")
PROFILES: Final = ("fast", "paper", "smoke")
STATES: Final = ("finished",) * 8 + ("stopped", "failed")
TAGS: Final = ("paper", "sweep", "keep", "odd")
FIRST: Final = datetime(2026, 1, 1, tzinfo=UTC)
ALPHABET: Final = "abcdefghijklmnopqrstuvwxyz0123456789"


def make_runs(root: Path, count: int, epochs: int = 30) -> list[str]:
    """Fill `root` with `count` ended runs named "bench-0000" and so on; returns their ids, oldest first.

    Nothing is flushed to the disk: this is for measurements and tests, where two thousand may take seconds at most.

    Args:
        root: the runs folder, made where it is missing.
        count: number of runs.
        epochs: metrics rows of each.
    """
    root.mkdir(parents=True, exist_ok=True)
    return [_make_run(root, number, epochs) for number in range(count)]


def _make_run(root: Path, number: int, epochs: int) -> str:
    draw = random.Random(number)
    when = FIRST + timedelta(minutes=7 * number)
    run_id = f"{when:%Y%m%d-%H%M%S}-{''.join(draw.choices(ALPHABET, k=6))}"
    folder = root / run_id
    (folder / "policies").mkdir(parents=True)
    (folder / "evaluations").mkdir()
    variant = VARIANTS[number // 10 % len(VARIANTS)]
    curriculum = variant not in ("td3", "sac", "ppo")
    config = {
        "scenario": "default", "curriculum": curriculum, "missiles": 4, "guide": "", "variant": variant,
        "profile": PROFILES[number // 80 % len(PROFILES)], "seed": number % 10, "name": f"bench-{number:04}",
    }  # fmt: skip
    rows = [_row(epoch, epochs, 4 if curriculum else 1, draw) for epoch in range(epochs)]
    _put(folder / "config.json", config)
    _put(folder / "state.json", _state(draw, when, rows))
    if number % 5 == 0:
        _put(folder / "notes.json", {"text": f"note {number}", "tags": [draw.choice(TAGS)]})
    if rows:
        _put(folder / "policy.json", {"evaluation": {"mean_return": rows[-1]["return_mean"]}})
    (folder / "metrics.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return run_id


def _state(draw: random.Random, when: datetime, rows: list[dict[str, Any]]) -> dict[str, Any]:
    state = draw.choice(STATES)
    last = rows[-1] if rows else {}
    return {
        "state": state, "stage": last.get("stage", 0), "stages": last.get("stages", 1), "task": last.get("task", ""),
        "progress": 1.0 if state == "finished" else 0.6, "created": when.isoformat(), "started": when.isoformat(),
        "updated": when.isoformat(), "wall_s": 600.0 * draw.random(), "best_success_rate": last.get("success_rate"),
        "error": "it was made to fail" if state == "failed" else "",
    }  # fmt: skip


def _row(index: int, epochs: int, stages: int, draw: random.Random) -> dict[str, Any]:
    """A stage's success rises to something like 0.9 and falls back when the next begins."""
    length = max(epochs // stages, 1)
    stage = min(index // length, stages - 1)
    epoch = index - stage * length + 1
    success = min(max((0.95 - 0.1 * draw.random()) * (1.0 - math.exp(-3.0 * epoch / length)), 0.0), 1.0)
    return {
        "stage": stage, "stages": stages, "task": _task(stages - 1 - stage), "epoch": epoch, "epochs": length,
        "missiles": list(range(1, 5 - (stages - 1 - stage))), "env_steps": 20_000 * epoch, "updates": 300 * epoch,
        "success_rate": round(success, 4), "return_mean": round(-400.0 + 900.0 * success, 2), "alpha": 1.0 - success,
        "epsilon": 1.0 - success, "beta": success, "train_success_rate": round(0.9 * success, 4),
        "train_return_mean": round(-400.0 + 800.0 * success, 2), "transfer_share": 0.8,
        "critic_loss": 0.1 / epoch, "actor_loss": -0.2, "q_mean": 3.0, "updates_per_s": 300.0,
        "env_steps_per_s": 5000.0, "wall_s": 4.0 * epoch, "eta_s": 0.0,
    }  # fmt: skip


def _task(masked: int) -> str:
    return f"source-{masked}" if masked else "target"


def _put(path: Path, value: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(value))
