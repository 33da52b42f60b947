"""Policies of a comparison: what is flown on which task, and what must be said about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from agents.policy import Policy, PolicyError, bind
from sim.assets import asset_path
from sim.errors import SubMasError
from sim.task import Task
from workbench.comparison.work import Kind, Work, mask_text
from workbench.policies import EXPERTS, SUFFIX, policy_choices, resolve_policy, shipped_cards, shipped_policies
from workbench.reproduce.provenance import file_digest
from workbench.runs import RunStore
from workbench.scenarios import trained_elsewhere

CHAIN = "submas-chain"
CHAIN_LABEL = "SubMas-RL, each task's own policy (shipped)"
"""Fig. 13 shows on every task the policy that was trained for it."""


@dataclass(frozen=True)
class Entry:
    """One policy on one task of the comparison."""

    spec: str
    """As chosen: POLICY or `CHAIN`."""
    policy: str
    """POLICY that flies; empty if none can."""
    digest: str = ""
    """Identifies its file; empty for a rule."""
    blind: str = ""
    """Why it cannot fly here; empty if it can."""
    note: str = ""
    """That it flies something else than it was trained for; empty if it does not."""

    def work(self, kind: Kind, scenario: str, task: Task, seed: int, **more: Any) -> Work:
        """The piece of work that flies it."""
        return Work(
            kind=kind, policy=self.policy, policy_digest=self.digest, scenario=scenario,
            scenario_digest=task.scenario.digest, mask=mask_text(task), seed=seed, **more,
        )  # fmt: skip


def comparison_choices(store: RunStore) -> dict[str, str]:
    """Every policy that can be compared, label -> spec; the chain of the shipped ones first."""
    chain = {CHAIN_LABEL: CHAIN} if "submas-target" in shipped_policies() else {}
    return chain | policy_choices(store)


def entry(spec: str, task: Task, store: RunStore) -> Entry:
    """A policy on a task; one that cannot fly there says why."""
    policy = chain_policy(task) if spec == CHAIN else spec
    if not policy:
        return Entry(spec, "", blind=f"no policy trained for {task.name} of {task.scenario.name} is shipped")
    try:
        flown = resolve_policy(policy, store)
        bind(flown, task)
        return Entry(spec, policy, policy_digest(policy, store), note=_note(flown, task))
    except PolicyError as error:
        return Entry(spec, "", blind=str(error).partition(";")[0])
    except SubMasError as error:
        return Entry(spec, "", blind=str(error))


def chain_policy(task: Task) -> str:
    """The shipped POLICY that was trained for exactly this task, navigation without missiles; empty if none was."""
    if not task.missiles:
        return "expert-navigation"
    here = task.scenario.digest
    found = (n for n, card in shipped_cards().items() if (card.missiles, card.scenario_digest) == (task.missiles, here))
    return next(found, "")


def policy_digest(policy: str, store: RunStore) -> str:
    """Identifies a policy's file by its bytes; empty for a rule.

    Raises:
        SubMasError: there is no such run, or no policy in it.
    """
    if policy in EXPERTS:
        return ""
    if policy in shipped_policies():
        return file_digest(asset_path("policies", policy + SUFFIX))
    path = store.get(policy).policy_path()
    if path is None:
        raise PolicyError(f"run {policy} has no policy yet")
    return file_digest(path)


def _note(policy: Policy, task: Task) -> str:
    elsewhere = trained_elsewhere(policy, task)
    card = getattr(policy, "card", None)
    if elsewhere or card is None or card.missiles == task.missiles:
        return elsewhere
    return (
        f"policy '{policy.name}' was trained for {card.task}; elsewhere it sees the masked missiles as never detected"
    )
