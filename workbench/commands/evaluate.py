"""`workbench evaluate`: success rate and more over many engagements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from agents.evaluation import Evaluation

EPISODES_LIMIT = 1_000_000


@dataclass(frozen=True)
class Args:
    """Fly many engagements from random initial states and report how they end."""

    policy: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="POLICY")]
    """Who flies: a shipped name (submas-target, expert-dragging, ...), a run, or a path to a policy file."""
    mask: str = ""
    """Masked missiles, as in 1,2; none is the target task."""
    episodes: int = 1000
    """Number of engagements."""
    seed: int = 0
    """Seed of the initial states."""
    scenario: str = "default"
    """Scenario: a shipped name or a path to a scenario file."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Evaluate and print."""
    from agents.evaluation import evaluate
    from sim.errors import UsageError
    from sim.task import task_for
    from workbench.policies import resolve_policy
    from workbench.progress import bar
    from workbench.runs import RunStore
    from workbench.scenarios import task_title, trained_elsewhere
    from workbench.terminal import print_json, print_warning

    if not 1 <= args.episodes <= EPISODES_LIMIT:
        raise UsageError(f"--episodes is {args.episodes}; legal are 1 to {EPISODES_LIMIT}")
    if args.seed < 0:
        raise UsageError(f"--seed is {args.seed}; it must not be negative")
    task = task_for(args.scenario, args.mask)
    policy = resolve_policy(args.policy, RunStore(args.runs))
    with bar(f"{policy.name} on {task_title(task)}", "engagements") as progress:
        evaluation = evaluate(policy, task, args.episodes, args.seed, progress=progress)
    warning = trained_elsewhere(policy, task)
    if args.json:
        print_json({**evaluation.to_json(), "scenario_digest": task.scenario.digest, "warning": warning or None})
        return 0
    _show(evaluation, task_title(task))
    if warning:
        print_warning(warning)
    return 0


def _show(evaluation: Evaluation, task: str) -> None:
    from workbench.terminal import percent, print_table

    figures = evaluation.to_json()
    low, high = figures["success_ci95"]
    outcomes = {name.replace("_", " "): count for name, count in figures["outcomes"].items()}
    rows = [
        ("success", f"{percent(figures['success_rate'])}  (95 %: {percent(low)} to {percent(high)})"),
        ("mean return", f"{figures['mean_return']:.1f}"),
        ("mean length", f"{figures['mean_length_s']:.0f} s"),
        ("outcomes", ", ".join(f"{name} {count}" for name, count in outcomes.items())),
        ("missiles evaded", f"{figures['missiles_evaded_mean']:.2f} per engagement"),
        ("speed", f"{figures['env_steps_per_s']:,.0f} env-steps/s"),
    ]
    title = f"{figures['policy']} on {task}: {figures['episodes']} engagements, seed {figures['seed']}"
    print_table(("figure", "value"), rows, title=title)
