"""A recorder that remembers everything it is told."""

from __future__ import annotations

from typing import Any

from agents.checkpoint import PolicyCard
from agents.policy import NetworkPolicy


class Recording:
    def __init__(self, stop_after: int | None = None) -> None:
        self.rows: list[dict[str, Any]] = []
        self.events: list[tuple[str, str, dict[str, Any]]] = []
        self.policies: list[tuple[NetworkPolicy, PolicyCard]] = []
        self.stop_after = stop_after

    def epoch(self, row: dict[str, Any]) -> None:
        self.rows.append(row)

    def event(self, kind: str, text: str, **fields: Any) -> None:
        self.events.append((kind, text, fields))

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        self.policies.append((policy, card))

    def should_stop(self) -> bool:
        return self.stop_after is not None and len(self.rows) >= self.stop_after

    def kinds(self) -> list[str]:
        return [kind for kind, _, _ in self.events]
