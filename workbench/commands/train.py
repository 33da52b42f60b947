"""`workbench train`: train one stage or the whole curriculum, one run per seed, and watch it."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from workbench.engine_options import LOCAL, EngineOptions
from workbench.stack_options import ONE_BY_ONE, StackOptions

if TYPE_CHECKING:
    from agents.config import TrainingConfig
    from workbench.runs import Run


@dataclass(frozen=True)
class Args:
    """Train SubMas-RL. Runs outlive this command; Ctrl-C asks them to stop at the end of the epoch."""

    curriculum: bool = False
    """Learn the whole chain of Algorithm 3: one missile, then two, up to the target task."""
    missiles: int | None = None
    """Learn a single stage with missiles 1 to N unmasked (default: all of them)."""
    mask: str = ""
    """Mask these missiles besides, as in 1,3: any of the 16 tasks, as a stage or as the target of a chain."""
    order: str = ""
    """With --curriculum: Algorithm 3's list, the most complex missile first, as in 4,1,2,3 (default: highest first)."""
    guide: str = ""
    """POLICY that guides the first stage (default: the one for the task with a missile less)."""
    variant: str = "submas"
    """Table 3: submas, wo-pd, wo-pr, dec-pd or dec-pr; or from scratch: td3, sac or ppo. Several between commas."""
    profile: str = "fast"
    """Settings: fast, paper (Table 2 exactly) or smoke (seconds, to try things out)."""
    seeds: str = "0"
    """One run per seed (and variant): 0 or 0,1,2 or 0-4."""
    scenario: str = "default"
    """Scenario: a shipped name or a path to a scenario file."""
    name: str = ""
    """A name to find the runs by."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    where: Annotated[EngineOptions, tyro.conf.arg(name="")] = LOCAL
    """Where the runs work."""
    stack: Annotated[StackOptions, tyro.conf.arg(name="")] = ONE_BY_ONE
    """Whether they learn together, and on which device."""
    json: bool = False
    """Print one JSON object."""


def run(args: Args) -> int:
    """Launch a run per seed and follow them to their ends."""
    from workbench.engine import open_engine
    from workbench.follow import follow
    from workbench.policies import guide_for
    from workbench.runs import RunStore
    from workbench.seeds import parse_seeds
    from workbench.stacked_launch import launch_stacked

    store = RunStore(args.runs)
    args.stack.check(args.where.engine)
    each = [dataclasses.replace(args, variant=name.strip()) for name in args.variant.split(",")]
    configs = [configuration(one, seed) for seed in parse_seeds(args.seeds) for one in each]
    guide_for(configs[0], store)  # a guide that is missing is said now, not in a log
    with open_engine(args.where, store) as engine:
        together = args.stack.together
        runs = launch_stacked(store, configs, args.stack) if together else [engine.launch(one) for one in configs]
        interrupted = follow(engine, runs)
    report(runs, args.json)
    if interrupted:
        return 130
    return failures(runs)


def configuration(args: Args, seed: int) -> TrainingConfig:
    """What one run is asked to do.

    Raises:
        UsageError: a value that is not legal, or --curriculum together with --missiles.
    """
    from agents.config import TrainingConfig
    from sim.errors import UsageError
    from sim.scenario_file import load_scenario

    if args.curriculum and args.missiles is not None:
        raise UsageError("--curriculum learns every stage and --missiles a single one; give one of them")
    most = load_scenario(args.scenario).launch.missiles
    missiles = most if args.missiles is None else args.missiles
    if not 1 <= missiles <= most:
        raise UsageError(f"--missiles is {missiles}; legal are 1 to {most}")
    scenario = _absolute(args.scenario)
    values = {"scenario": scenario, "variant": args.variant, "profile": args.profile, "name": args.name}
    values |= {"mask": args.mask, "order": args.order}
    guide = _absolute(args.guide)
    return TrainingConfig.from_json(
        {**values, "curriculum": args.curriculum, "missiles": missiles, "guide": guide, "seed": seed}
    )


def _absolute(name: str) -> str:
    # The training process may outlive this folder being the current one; a path must mean the same file there.
    path = Path(name)
    return str(path.absolute()) if path.suffix and path.is_file() else name


def report(runs: Sequence[Run], as_json: bool) -> None:
    """How trainings ended, as a table or as one JSON object."""
    from workbench.terminal import duration, percent, print_json, print_table

    summaries = [summary(run) for run in runs]
    if as_json:
        print_json({"runs": summaries})
        return
    several, rows = len({one["variant"] for one in summaries}) > 1, []
    for one in summaries:
        seed = f"{one['seed']} {one['variant']}" if several else str(one["seed"])
        for stage in one["stages"] or [{"task": "–", "success_rate": None, "epochs": 0, "wall_s": 0.0}]:
            figures = (percent(stage["success_rate"]), str(stage["epochs"]), duration(stage["wall_s"]))
            rows.append((seed, one["id"], one["state"], stage["task"], *figures))
    print_table(("seed", "run", "state", "stage", "success", "epochs", "time"), rows)


def summary(run: Run) -> dict[str, Any]:
    """One run as JSON: how it ended, what each stage reached, where its policy is."""
    from workbench.stages import summarise

    policy = run.policy_path()
    return {
        "id": run.id,
        "seed": run.config.seed,
        "variant": run.config.variant,
        "state": run.state.state,
        "stages": summarise(run.metrics()),
        "policy": str(policy) if policy else None,
    }


def failures(runs: Sequence[Run]) -> int:
    """Say on standard error which trainings failed and why; the exit code."""
    from workbench.terminal import print_line

    failed = [run for run in runs if run.state.state in ("failed", "interrupted")]
    for run in failed:
        reason = run.state.error or "its process ended without a word"
        print_line(
            f"workbench: run {run.id} {run.state.state}: {reason}; see {run.path / 'log.txt'}, "
            f"and 'workbench resume {run.id}' lets it go on",
            error=True,
        )
    return 1 if failed else 0
