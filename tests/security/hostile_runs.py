"""A runs folder in which everything that can be named is named by somebody who means harm."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

from agents.config import TrainingConfig
from tests.reliability.fake_training import metrics_row
from tests.security.hostile import EVERY, PRINTABLE, STEERING
from workbench.run_files import append_line
from workbench.run_folder import now
from workbench.run_state import RunState
from workbench.runs import Run, RunStore


def fill(root: Path) -> RunStore:
    """A run for each name; what is no legal name stands in the files as a foreign or damaged program would leave it."""
    store = RunStore(root)
    for name in PRINTABLE:
        said(store.create(TrainingConfig(profile="smoke", missiles=1, name=name)), name)
    for name in STEERING:
        run = store.create(TrainingConfig(profile="smoke", missiles=1, name="steers"))
        said(run, name)
    for name in STEERING[:4]:
        run = store.create(TrainingConfig(profile="smoke", missiles=1))
        (run.path / "config.json").write_text(json.dumps({"profile": "smoke", "name": name, name: 1}))
    return store


def said(run: Run, text: str) -> None:
    """A run that ended and in whose every file `text` stands."""
    stamp = now()
    run.write_state(
        RunState("failed", task=text, created=stamp, started=stamp, updated=stamp, error=text, wall_s=1.0, progress=0.5)
    )
    for epoch in (1, 2):
        append_line(run.path / "metrics.jsonl", {**metrics_row(epoch, 2), "task": text})
    append_line(run.path / "events.jsonl", {"time": stamp, "kind": text or "x", "text": text, "wall_s": 1.0})
    (run.path / "notes.json").write_text(json.dumps({"text": text, "tags": [tag(text)]}))
    (run.path / "log.txt").write_text(text, errors="replace")


def tag(text: str) -> str:
    """As much of the text as a tag may be."""
    return "".join(c for c in text if c.isprintable() and c != ",").strip()[:40] or "tag"


def scenario_file(path: Path, name: str) -> Path:
    """A legal scenario of this name."""
    from sim.scenario_file import load_scenario, scenario_text

    path.write_text(scenario_text(dataclasses.replace(load_scenario("short-range"), name=name, description=name)))
    return path


def policy_file(path: Path, name: str) -> Path:
    """A legal policy of this name: the shipped one under another."""
    from agents.checkpoint import load_policy, save_policy
    from sim.assets import asset_path

    policy = load_policy(asset_path("policies", "submas-source-3.safetensors"))
    assert policy.card is not None
    save_policy(path, policy, dataclasses.replace(policy.card, name=name))
    return path


__all__ = ["EVERY", "fill", "policy_file", "said", "scenario_file", "tag"]
