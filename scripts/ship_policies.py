#!/usr/bin/env python3
"""Choose the chain of policies that comes with the workbench: `python scripts/ship_policies.py RUNS`.

Every policy of every finished SubMas-RL chain of the `fast` profile in the folder RUNS flies 1000 engagements of its
own task, and so does the dragging expert. The chain whose least lead over the expert on any task is the greatest is
copied to assets/policies; of several, the one with the most successes over all tasks. The engagements are those that
Table 4 chooses seeds by: nobody trains on them, and no reported number comes from them.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from agents.checkpoint import load_policy
from agents.evaluation import evaluate
from agents.expert import DraggingExpert
from agents.policy import Policy
from sim.task import task_for
from workbench.reproduce.places import ROOT
from workbench.reproduce.plan import CHAIN, MISSILES
from workbench.reproduce.protocol import EPISODES, SELECTION_SEED
from workbench.runs import Run, RunStore
from workbench.terminal import percent, print_table

TASKS = CHAIN[1:]
POLICIES = ROOT / "assets/policies"


def chains(store: RunStore) -> Iterator[Run]:
    """Finished SubMas-RL curricula of the `fast` profile on the default scenario, by seed."""
    good = [run for run in store.list() if not run.problem and run.state.state == "finished"]
    wanted = {"curriculum": True, "variant": "submas", "profile": "fast", "scenario": "default", "missiles": MISSILES}
    fitting = [run for run in good if wanted.items() <= run.config.to_json().items()]
    yield from sorted(fitting, key=lambda run: run.config.seed)


def successes(run: Run) -> dict[str, float]:
    """Success rate of each stage's policy on its own task, by the task's name."""
    return {task: success(load_policy(policy_file(run, task)), task) for task in TASKS}


def success(policy: Policy, task: str) -> float:
    """Success rate on the engagements that choose."""
    masked = ",".join(map(str, range(TASKS.index(task) + 2, MISSILES + 1)))
    return evaluate(policy, task_for("default", masked), EPISODES, SELECTION_SEED).success_rate


def merit(shares: dict[str, float], expert: dict[str, float]) -> tuple[float, float]:
    """The least lead over the expert on any task, then the sum over all tasks; of two chains the greater is better."""
    # Rounded to whole engagements: a difference of floating point is no lead.
    return min(round(EPISODES * (shares[task] - expert[task])) for task in TASKS), sum(shares.values())


def policy_file(run: Run, task: str) -> Path:
    """File of a stage's policy."""
    return run.path / "policies" / f"{task}.safetensors"


def main(arguments: list[str]) -> int:
    """Evaluate, show, copy; returns the exit code."""
    if len(arguments) != 1 or not Path(arguments[0]).is_dir():
        print("usage: python scripts/ship_policies.py RUNS, a folder with runs", file=sys.stderr)
        return 2
    found = [(run, successes(run)) for run in chains(RunStore(Path(arguments[0])))]
    if not found:
        print(f"{arguments[0]} holds no finished SubMas-RL curriculum of the fast profile", file=sys.stderr)
        return 1
    expert = {task: success(DraggingExpert(), task) for task in TASKS}
    best, _ = max(found, key=lambda one: merit(one[1], expert))
    rows = [("expert", *(percent(expert[task]) for task in TASKS), "")]
    for run, shares in found:
        rows.append(
            (str(run.config.seed), *(percent(shares[task]) for task in TASKS), "shipped" if run is best else "")
        )
    print_table(("seed", *TASKS, ""), rows, title=f"Success in {EPISODES} engagements, seed {SELECTION_SEED}")
    for task in TASKS:
        for suffix in (".safetensors", ".json"):
            shutil.copyfile(policy_file(best, task).with_suffix(suffix), POLICIES / f"submas-{task}{suffix}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
