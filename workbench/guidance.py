"""What the guide of a learned policy would have done along a recorded flight, and where its knowledge held (Eq. 13)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from agents.features import adapt
from agents.policy import NetworkPolicy
from agents.transfer_mask import TransferMask
from layouts.controls import GuideTrace
from sim.errors import SubMasError
from sim.observation import UNLAUNCHED, ObservationLayout
from workbench.policies import guide_for, resolve_policy, shipped_cards
from workbench.runs import RunStore, is_run_id

if TYPE_CHECKING:
    from agents.checkpoint import PolicyCard
    from agents.policy import Policy
    from sim.trajectory import Trajectory

NAVIGATION = "expert-navigation"


def guide_trace(flight: Trajectory, policy: Policy, spec: str, store: RunStore) -> GuideTrace | None:
    """The guide of the stage that made `policy`, asked at every step of a flight.

    None where there is nothing to tell: the policy is a rule or learned from scratch, or its guide is gone.

    Args:
        flight: what `policy` flew.
        policy: who flew.
        spec: POLICY it was resolved from.
        store: where runs are.
    """
    if not isinstance(policy, NetworkPolicy) or policy.card is None:
        return None
    guide = _guide(policy.card, spec, store)
    if guide is None:
        return None
    target = ObservationLayout(tuple(policy.card.missiles))
    source = ObservationLayout(_known(guide, policy.card))
    if not set(source.missiles) < set(target.missiles):
        return None
    return _trace(flight, guide, target, source)


def _trace(flight: Trajectory, guide: Policy, target: ObservationLayout, source: ObservationLayout) -> GuideTrace:
    seen = adapt(flight.observation.astype(np.float32), flight.task.layout, target, UNLAUNCHED)
    mask = TransferMask(target, source, UNLAUNCHED)
    action = np.asarray(guide.act(mask.shared(seen), source), dtype=float).reshape(len(seen))
    fresh = tuple(missile for missile in target.missiles if missile not in source.missiles)
    return GuideTrace(guide.name, fresh, mask.allowed(seen), action)


def _guide(card: PolicyCard, spec: str, store: RunStore) -> Policy | None:
    from agents.config import VARIANTS

    if card.variant not in VARIANTS or not VARIANTS[card.variant].guided:
        return None
    try:
        return _guide_of_run(card, spec, store) if is_run_id(spec) else _shipped_guide(card)
    except (SubMasError, OSError):  # deleted since, or damaged: the flight can be shown without it
        return None


def _shipped_guide(card: PolicyCard) -> Policy | None:
    """The policy of the chain one stage before, or navigation for the first stage."""
    if len(card.missiles) == 1:
        return resolve_policy(NAVIGATION)
    for name, other in shipped_cards().items():
        if _precedes(other.missiles, card.missiles) and other.scenario_digest == card.scenario_digest:
            return resolve_policy(name)
    return None


def _guide_of_run(card: PolicyCard, spec: str, store: RunStore) -> Policy | None:
    run = store.get(spec)
    if run.config.curriculum:
        for path in sorted((run.path / "policies").glob("*.safetensors")):
            earlier = resolve_policy(str(path))
            if isinstance(earlier, NetworkPolicy) and _precedes(_missiles(earlier), card.missiles):
                return earlier
    return guide_for(run.config, store)


def _precedes(earlier: Sequence[int], later: Sequence[int]) -> bool:
    return set(earlier) < set(later) and len(earlier) == len(later) - 1


def _known(guide: Policy, card: PolicyCard) -> tuple[int, ...]:
    """Missiles that a guide knows, as `agents.submas.source_of` takes it: its own, none, or all but the hardest."""
    if isinstance(guide, NetworkPolicy):
        return tuple(missile for missile in _missiles(guide) if missile in card.missiles)
    return () if guide.name == NAVIGATION else tuple(card.missiles)[:-1]


def _missiles(policy: NetworkPolicy) -> tuple[int, ...]:
    return tuple(policy.layout.missiles)  # pyright: ignore[reportAttributeAccessIssue]
