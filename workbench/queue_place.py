"""The place of a waiting run in the queue of this machine, and when it will probably start."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from workbench.run_state import RunState

Usual = Callable[[str], float | None]
"""How long the run of this id usually takes as a whole [s]; None where that is not known."""


@dataclass(frozen=True)
class QueuePlace:
    """Which of how many waiting runs starts next but how many."""

    place: int
    """1 for the next one."""
    waiting: int
    starts_s: float | None = None
    """Expected time until it starts [s]; None while nobody knows how long those before it take."""


def queue_place(run_id: str, states: dict[str, RunState], cores: int, usual: Usual) -> QueuePlace | None:
    """The place of a run, oldest first, as `launcher.drain` starts them; None if it does not wait for a core.

    Args:
        run_id: the run.
        states: how every run under way stands, by id; those of a cluster wait for its nodes instead.
        cores: trainings that work at once.
        usual: tells how long a run takes.
    """
    here = {each: state for each, state in states.items() if not state.engine}
    queue = sorted((state.created, each) for each, state in here.items() if state.state == "queued")
    order = [each for _created, each in queue]
    if run_id not in order:
        return None
    before = order[: order.index(run_id)]
    working = [_left_s(each, state, usual) for each, state in here.items() if state.state != "queued"]
    starts_s = _starts_s([*working, *([0.0] * (cores - len(working)))], [usual(each) for each in before])
    return QueuePlace(len(before) + 1, len(order), starts_s)


def _left_s(run_id: str, state: RunState, usual: Usual) -> float | None:
    """Time a working run probably goes on [s]: what is usual, but never more than its own estimate at most."""
    whole_s = usual(run_id)
    known = [left for left in (None if whole_s is None else whole_s - state.wall_s, state.eta_s) if left is not None]
    return max(min(known), 0.0) if known else None


def _starts_s(left_s: Sequence[float | None], before_s: Sequence[float | None]) -> float | None:
    """When a core is free for one more run [s]: each run before it takes the core that is free first."""
    cores = [left for left in left_s if left is not None]
    if len(cores) < len(left_s) or any(taken is None for taken in before_s):
        return None
    heapq.heapify(cores)
    # More may work than there are cores, if some were resumed by hand: those of the surplus make no room.
    for taken in before_s:
        heapq.heapreplace(cores, cores[0] + (taken or 0.0))
    return cores[0] if cores else None
