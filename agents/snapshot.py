"""A training at the end of an epoch, as plain values and arrays: what it is resumed from, bit for bit.

Nothing here needs torch; `agents/resume.py` takes snapshots of a learner and puts them back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from agents.arrays import Arrays, below
from agents.checkpoint import card_from_json
from agents.hyperparameters import Hyperparameters
from agents.policy import NetworkPolicy, Policy
from agents.task import Domain
from sim.errors import SubMasError

if TYPE_CHECKING:
    from agents.replay import StoredSlots


class SnapshotError(SubMasError):
    """A snapshot does not fit the training that is to be resumed from it."""


@dataclass(frozen=True)
class Snapshot:
    """All that the rest of a training depends on, besides its configuration."""

    stage: int
    """Stage that is being learned, from 0; those before it are done."""
    values: Mapping[str, Any]
    """Numbers and texts, as plain JSON values."""
    arrays: Mapping[str, NDArray[Any]]
    """Networks, moments, generators, worlds and policies."""
    slots: StoredSlots | None = None
    """Experience by time slot; None for a learner that keeps none between two epochs."""

    @property
    def hyperparameters(self) -> Hyperparameters:
        """The numbers that the training began with.

        Raises:
            SnapshotError: they are not those of this version.
        """
        try:
            values = dict(self.values["hyper"])
            return Hyperparameters(**{**values, "hidden": tuple(values["hidden"])})
        except (KeyError, TypeError, ValueError) as error:
            raise SnapshotError(f"the checkpoint's hyperparameters are not those of this version: {error}") from None

    @property
    def route(self) -> str:
        """The route of matrix products that the training took."""
        return str(self.values.get("route", ""))

    def checked_stage(self, stages: int) -> int:
        """The stage, if a training has so many.

        Raises:
            SnapshotError: it has fewer.
        """
        if not 0 <= self.stage < stages:
            raise SnapshotError(f"the checkpoint is of stage {self.stage + 1}, and the training has {stages}")
        return self.stage

    def guide(self, given: Policy, domain: Domain) -> Policy:
        """The guide of the stage: the network that was kept, or the rule that is `given` again."""
        kept = self.values.get("guide")
        if kept is not None:
            return policy_from(kept, below("guide", self.arrays), domain)
        if "guide_generator" in self.values:
            generator: np.random.Generator = getattr(given, "generator")  # noqa: B009 - only the random policy has one
            generator.bit_generator.state = self.values["guide_generator"]
        return given


def policy_values(policy: NetworkPolicy) -> dict[str, Any]:
    """A network policy without its weights, as JSON values."""
    return {
        "name": policy.name,
        "subtasks": list(policy.features.subtasks),
        "action_limit": float(policy.action_limit),
        "activation": policy.activation,
        "squash": policy.squash,
        "card": policy.card and policy.card.to_json(),
    }


def policy_arrays(policy: NetworkPolicy) -> Arrays:
    """Its weights."""
    pairs = enumerate(policy.layers)
    return {
        f"{index}/{name}": part for index, pair in pairs for name, part in zip(("weight", "bias"), pair, strict=True)
    }


def policy_from(values: Mapping[str, Any], arrays: Arrays, domain: Domain) -> NetworkPolicy:
    """Inverse of `policy_values` and `policy_arrays`.

    Raises:
        PolicyFileError: its card is not one of this version.
    """
    card = values["card"] and card_from_json(dict(values["card"]), f"the checkpoint's policy '{values['name']}'")
    return NetworkPolicy(
        values["name"],
        domain.features(domain.layout(tuple(values["subtasks"]))),
        [(arrays[f"{index}/weight"], arrays[f"{index}/bias"]) for index in range(len(arrays) // 2)],
        values["action_limit"],
        card,
        activation=values["activation"],
        squash=values["squash"],
    )
