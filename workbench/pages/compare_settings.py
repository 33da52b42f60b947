"""What the Compare page shows, as its address says it.

`?policies=&tasks=&scenario=&episodes=&seed=&task=&policy=&against=`; policies and tasks are lists with commas.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from sim.scenario_file import load_scenario
from workbench.comparison.grid import tasks_of
from workbench.comparison.policies import CHAIN
from workbench.pages.fly_settings import LONGEST, SEED_MAX, read_scenario
from workbench.reproduce.protocol import REPORT_SEED
from workbench.scenarios import DEFAULT

FEWEST, MOST = 10, 10_000
"""Engagements of each policy on each task."""
POLICIES_MOST, TASKS_MOST = 8, 16
SHOWN_FIRST = (CHAIN, "submas-target", "expert-dragging")
"""Fig. 13: each task's own policy and the expert; between them the policy that learned the target task."""


@dataclass(frozen=True)
class CompareSettings:
    """Policies, tasks, engagements, and what is looked at more closely."""

    policies: tuple[str, ...]
    tasks: tuple[str, ...]
    """Names of tasks, from the easiest to the hardest."""
    scenario: str = DEFAULT
    episodes: int = 1000
    seed: int = REPORT_SEED
    task: str = ""
    """Task looked at closely."""
    policy: str = ""
    """Policy looked at closely."""
    against: str = ""
    """Policy it is paired with."""

    def to_query(self) -> dict[str, str]:
        """Values of the address; reading them gives equal settings."""
        lists = {"policies": ",".join(self.policies), "tasks": ",".join(self.tasks)}
        numbers = {"episodes": str(self.episodes), "seed": str(self.seed)}
        return {**lists, "scenario": self.scenario, **numbers, "task": self.task, "policy": self.policy,
                "against": self.against}  # fmt: skip


def default_settings(policies: Collection[str], scenario: str = DEFAULT) -> CompareSettings:
    """Fig. 13: the shipped policies and the dragging expert on the tasks of the chain."""
    shown = tuple(policy for policy in SHOWN_FIRST if policy in policies)
    return looked_at(CompareSettings(shown, chain_tasks(scenario), scenario))


def chain_tasks(scenario: str) -> tuple[str, ...]:
    """Names of the tasks of the chain, from no missile to all."""
    missiles = load_scenario(scenario).launch.missiles
    return tuple(tasks_of(load_scenario(scenario)))[: missiles + 1]


def looked_at(settings: CompareSettings) -> CompareSettings:
    """The same with a task and two policies that are among those compared: the hardest, the first, the expert."""
    policies, tasks = settings.policies, settings.tasks
    if not policies or not tasks:
        return replace(settings, task="", policy="", against="")
    others = [policy for policy in policies if policy != settings.policy]
    usual = "expert-dragging" if "expert-dragging" in policies else policies[-1]
    against = settings.against if settings.against in others else usual
    policy = settings.policy if settings.policy in policies else next((p for p in policies if p != against), against)
    if policy == against:
        against = next((p for p in reversed(policies) if p != policy), policy)
    return replace(
        settings, task=settings.task if settings.task in tasks else tasks[-1], policy=policy, against=against
    )


def read_settings(
    query: Mapping[str, str], policies: Collection[str], scenarios: Collection[str]
) -> tuple[CompareSettings, list[str]]:
    """Settings of an address, and one sentence for each value that was wrong and left out or replaced.

    Args:
        query: names and values of the address, which anybody may have written.
        policies: what may be compared.
        scenarios: SCENARIO that may be flown in; nothing else is ever opened.
    """
    scenario, problems = read_scenario(query, scenarios, DEFAULT)
    defaults = default_settings(policies, scenario)
    known = list(tasks_of(load_scenario(scenario)))
    chosen, wrong = _listed(query, "policies", "Policy", list(policies), defaults.policies, POLICIES_MOST)
    tasks, strange = _listed(query, "tasks", "Task", known, defaults.tasks, TASKS_MOST)
    settings = replace(defaults, policies=chosen, tasks=tuple(task for task in known if task in tasks))
    for name, low, high in (("episodes", FEWEST, MOST), ("seed", 0, SEED_MAX)):
        text = query.get(name, "")
        if not text:
            continue
        if text.isascii() and text.isdigit() and len(text) < 17 and low <= int(text) <= high:
            settings = replace(settings, **{name: int(text)})
        else:
            legal = f"a whole number from {low} to {high}, so {getattr(defaults, name)} is taken."
            problems.append(f"{name.capitalize()} '{text[:LONGEST]}' is not {legal}")
    closely = {name: query.get(name, "") for name in ("task", "policy", "against")}
    return looked_at(replace(settings, **closely)), [*problems, *wrong, *strange]


def _listed(
    query: Mapping[str, str], name: str, what: str, known: Sequence[str], default: tuple[str, ...], most: int
) -> tuple[tuple[str, ...], list[str]]:
    """Known values of a list in the address, each once, and a sentence for what is left out."""
    if name not in query:
        return default, []
    values = list(dict.fromkeys(part for part in query[name].split(",") if part))
    strange = [value[:LONGEST] for value in values if value not in known]
    problems = [f"{what} '{value}' is not known here and is left out." for value in strange]
    found = [value for value in values if value in known]
    if len(found) > most:
        problems.append(f"The address names {len(found)} {name}; the first {most} are compared.")
    return tuple(found[:most]) or default, problems[:5]
