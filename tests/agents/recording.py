"""A recorder that remembers everything it is told."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from agents.checkpoint import PolicyCard
from agents.policy import NetworkPolicy
from agents.snapshot import Snapshot


@dataclass
class Kept:
    """Experience as it was when a snapshot was taken."""

    added: int
    kept: list[tuple[int, np.ndarray]]

    def blocks(self, first: int) -> Iterator[tuple[int, np.ndarray]]:
        return iter(self.kept)


class Recording:
    def __init__(self, stop_after: int | None = None) -> None:
        self.rows: list[dict[str, Any]] = []
        self.events: list[tuple[str, str, dict[str, Any]]] = []
        self.policies: list[tuple[NetworkPolicy, PolicyCard]] = []
        self.stop_after = stop_after
        self.snapshots: list[Snapshot] = []
        self.keep_snapshots = False

    def epoch(self, row: dict[str, Any]) -> None:
        self.rows.append(row)

    def event(self, kind: str, text: str, **fields: Any) -> None:
        self.events.append((kind, text, fields))

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        self.policies.append((policy, card))

    def checkpoint(self, take: Callable[[], Snapshot]) -> None:
        if self.keep_snapshots:
            taken = take()
            slots = taken.slots and Kept(
                taken.slots.added, [(first, rows.copy()) for first, rows in taken.slots.blocks(0)]
            )
            values = json.loads(json.dumps(taken.values, allow_nan=False))
            self.snapshots.append(dataclasses.replace(taken, values=values, slots=slots))

    def should_stop(self) -> bool:
        return self.stop_after is not None and len(self.rows) >= self.stop_after

    def kinds(self) -> list[str]:
        return [kind for kind, _, _ in self.events]
