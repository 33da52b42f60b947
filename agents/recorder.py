"""Where a training reports to: one metrics row per epoch, events, and every policy worth keeping."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from agents.checkpoint import PolicyCard
from agents.policy import NetworkPolicy

if TYPE_CHECKING:
    from agents.snapshot import Snapshot


class Recorder(Protocol):
    """Implemented by whoever keeps runs; the learner knows no folders."""

    def epoch(self, row: dict[str, Any]) -> None:
        """One row of metrics."""
        ...

    def event(self, kind: str, text: str, **fields: Any) -> None:
        """Something worth telling a person: `stage_started`, `best`, `promoted`, `stage_finished`, `stopped`."""
        ...

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        """A better policy of the current stage; once more at its end, with `card.final`."""
        ...

    def checkpoint(self, take: Callable[[], Snapshot]) -> None:
        """Offered after every epoch: a snapshot that training can be resumed from. It must be used up within the call.

        What is raised here ends the training at once; it can be resumed later.
        """
        ...

    def should_stop(self) -> bool:
        """Asked after every epoch; True ends the training with the best policy so far."""
        ...


class NoRecorder:
    """A recorder that keeps nothing."""

    def epoch(self, row: dict[str, Any]) -> None:
        """Forget the row."""

    def event(self, kind: str, text: str, **fields: Any) -> None:
        """Forget the event."""

    def policy(self, policy: NetworkPolicy, card: PolicyCard) -> None:
        """Forget the policy."""

    def checkpoint(self, take: Callable[[], Snapshot]) -> None:
        """Take none."""

    def should_stop(self) -> bool:
        """Never stop."""
        return False
