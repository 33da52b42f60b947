"""The policies in `assets/policies` are what their cards and the README say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from agents.checkpoint import load_policy
from agents.curriculum import build_curriculum
from agents.evaluation import evaluate
from sim.assets import asset_path
from sim.scenario_file import load_scenario
from sim.task import Task

TARGET = Task(load_scenario())
CHAIN = [task for task in build_curriculum(TARGET, (4, 3, 2, 1)).tasks if task.missiles]
README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("task", CHAIN, ids=lambda task: task.name)
def test_every_task_of_the_chain_has_a_policy_trained_for_the_scenario_as_it_is(task: Task) -> None:
    policy = load_policy(asset_path("policies", f"submas-{task.name}.safetensors"))
    assert policy.card is not None
    assert policy.name == policy.card.name == f"submas-{task.name}"
    assert (policy.card.missiles, policy.card.scenario_digest) == (task.missiles, task.scenario.digest)
    assert policy.card.final and policy.card.command.startswith("workbench train --curriculum")


@pytest.mark.parametrize("task", [task for task in CHAIN if task.masked], ids=lambda task: task.name)
def test_source_policies_solve_their_tasks(task: Task) -> None:
    policy = load_policy(asset_path("policies", f"submas-{task.name}.safetensors"))
    assert evaluate(policy, task, 300, seed=7).success_rate >= 0.95


def test_the_readmes_figure_is_what_its_command_gives() -> None:
    """On 1000 engagements that neither training nor the choice of the policy has seen."""
    told = re.search(r"workbench evaluate submas-target --episodes 1000 --seed 7` gives ([\d.]+) %", README)
    assert told, "README.md does not tell how often the shipped policy succeeds"
    policy = load_policy(asset_path("policies", "submas-target.safetensors"))
    evaluation = evaluate(policy, TARGET, 1000, seed=7)
    assert evaluation.success_rate >= 0.97
    # Other processors round differently; a few engagements of a thousand may then end otherwise.
    assert 100 * evaluation.success_rate == pytest.approx(float(told[1]), abs=0.5)
