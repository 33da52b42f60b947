"""Policies by name: what POLICY may be on the command line, in a page and in a training's `guide`."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from sim.assets import asset_path
from sim.errors import UsageError, shorten
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.runs import RunStore, is_run_id
from workbench.scenarios import other_scenario

if TYPE_CHECKING:
    from agents.checkpoint import PolicyCard
    from agents.config import TrainingConfig
    from agents.policy import Policy
    from sim.scenario import Scenario

SUFFIX = ".safetensors"
EXPERTS = {
    "expert-dragging": "Defensive dragging (expert)",
    "expert-navigation": "Navigation (expert)",
    "random": "Random",
}
"""Policies that are rules, not networks, with the words a page shows for them."""

SHIPPED_LABELS = {
    "submas-target": "SubMas-RL, target task (shipped)",
    "submas-source-1": "SubMas-RL, source task 1 (shipped)",
    "submas-source-2": "SubMas-RL, source task 2 (shipped)",
    "submas-source-3": "SubMas-RL, source task 3 (shipped)",
}


class UnknownPolicyError(UsageError):
    """POLICY is none of the names, not a run with a policy and not a policy file."""


def shipped_policies() -> list[str]:
    """Names of the trained policies that come with the workbench, the target task's first."""
    names = {path.stem for path in asset_path("policies").glob(f"*{SUFFIX}")}
    known = [name for name in SHIPPED_LABELS if name in names]
    return known + sorted(names - set(known))


def resolve_policy(spec: str, store: RunStore | None = None) -> Policy:
    """The policy that `spec` names: an expert, a shipped policy, a run (its best policy) or a policy file.

    Raises:
        UnknownPolicyError: nothing of that name.
        PolicyFileError: the file is damaged or not a policy.
    """
    if spec in EXPERTS:
        return _expert(spec)
    from agents.checkpoint import load_policy

    if spec in shipped_policies():
        return load_policy(asset_path("policies", spec + SUFFIX))
    if store is not None and is_run_id(spec):
        return load_policy(_run_policy(spec, store))
    if spec.endswith(SUFFIX) and (path := _file(spec)) is not None:
        return load_policy(path)
    raise UnknownPolicyError(_unknown(spec))


def _file(spec: str) -> Path | None:
    """The plain file of this path; None for anything else, also for what can be no path at all."""
    try:
        path = Path(spec).expanduser()
        return path if path.is_file() else None
    except (OSError, RuntimeError, ValueError):  # too long a name, `~nobody`, a zero byte
        return None


def _expert(name: str) -> Policy:
    from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy

    makers = {
        "expert-dragging": DraggingExpert,
        "expert-navigation": NavigationExpert,
        "random": RandomPolicy,
    }
    return makers[name]()


def _run_policy(run_id: str, store: RunStore) -> Path:
    run = store.get(run_id)
    path = run.policy_path()
    if path is None:
        raise UnknownPolicyError(f"run {run.id} has no policy yet; its first one is saved after the first evaluation")
    return path


def _unknown(spec: str) -> str:
    names = ", ".join([*EXPERTS, *shipped_policies()])
    if spec.endswith(SUFFIX):
        return f"policy file {shorten(spec)!r} does not exist; give a path to a {SUFFIX} file or one of: {names}"
    return f"policy {shorten(spec)!r} is unknown; use one of: {names}; or a run id; or a path to a {SUFFIX} file"


def policy_choices(store: RunStore) -> dict[str, str]:
    """Every policy that can be flown now, label -> POLICY: shipped ones, then experts, then runs."""
    shipped = {SHIPPED_LABELS.get(name, f"{name} (shipped)"): name for name in shipped_policies()}
    experts = {label: name for name, label in EXPERTS.items()}
    runs = {
        f"{title(run.config)} (run {run.id})": run.id for run in store.list() if not run.problem and run.policy_path()
    }
    return shipped | experts | runs


def title(config: TrainingConfig) -> str:
    """A training in a few words: its name if the user gave one, else what it learns; another scenario is named."""
    what = shorten(config.name, 40) or what_is_learned(config)
    words = [what, other_scenario(config.scenario), config.variant, config.profile]
    return " · ".join([*filter(None, words), f"seed {config.seed}"])


def what_is_learned(config: TrainingConfig) -> str:
    """The task or the chain of a training in a few words."""
    count, listed = len(config.subtasks), ", ".join(map(str, config.subtasks))
    if config.curriculum:
        to = f"Curriculum to missile{'s' * (count != 1)} {listed}" if config.mask else "Whole curriculum"
        return f"{to} in order {config.order.replace(',', ', ')}" if config.order else to
    return f"missile{'s' * (count != 1)} {listed}" if config.mask else f"{count} missile{'s' * (count != 1)}"


def natural_guide(config: TrainingConfig) -> str:
    """POLICY that guides the first stage when none is chosen: the policy of a task with one missile less.

    The easiest task (one missile) is guided by the navigation expert (section 4.1), and so is a whole curriculum;
    SAC and PPO have it and never ask it. Empty when no policy of that task, trained on this very scenario, is shipped.

    Raises:
        ScenarioError: there is no such scenario.
    """
    from agents.config import VARIANTS

    if config.curriculum or len(config.subtasks) == 1 or VARIANTS[config.variant].from_library:
        return "expert-navigation"
    target = Task(load_scenario(config.scenario))
    for last in reversed(config.subtasks):
        easier = target.mask(missile for missile in target.missiles if missile not in {*config.subtasks} - {last})
        card = shipped_cards().get(f"submas-{easier.name}")
        if card is not None and card.scenario_digest == target.scenario.digest:
            return f"submas-{easier.name}"
    # Who learns from scratch is never told anything, so any rule will do.
    return "" if VARIANTS[config.variant].guided else "expert-navigation"


def guide_for(config: TrainingConfig, store: RunStore | None = None) -> Policy:
    """The policy that guides a training's first stage.

    Raises:
        UnknownPolicyError: the chosen guide does not exist, or no natural one is shipped.
        ScenarioError: there is no such scenario.
    """
    spec = config.guide or natural_guide(config)
    if not spec:
        missiles, count = ", ".join(map(str, config.subtasks)), len(config.subtasks)
        task = f"{count - 1} missile{'s' * (count != 2)} of scenario '{config.scenario}'"
        raise UnknownPolicyError(
            f"no policy for {task} is shipped to guide a training with {missiles if config.mask else count}; "
            "choose one with --guide, or train the whole chain with --curriculum"
        )
    return resolve_policy(spec, store)


@cache
def shipped_cards() -> dict[str, PolicyCard]:
    """Cards of the shipped policies by name; a damaged file has none."""
    from agents.checkpoint import PolicyFileError, load_policy

    cards = {}
    for name in shipped_policies():
        try:
            card = load_policy(asset_path("policies", name + SUFFIX)).card
        except PolicyFileError:
            continue
        if card is not None:
            cards[name] = card
    return cards


def shipped_success(scenario: Scenario) -> dict[int, float]:
    """Held-out success rate, by number of missiles, of the shipped policies that were trained on this scenario."""
    cards = [card for card in shipped_cards().values() if card.scenario_digest == scenario.digest]
    return {len(card.missiles): float(card.evaluation["success_rate"]) for card in cards if card.evaluation}
