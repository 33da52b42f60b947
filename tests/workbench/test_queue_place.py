"""Who waits where, and until when: against a clock that goes on second by second."""

from __future__ import annotations

import itertools

import pytest

from workbench.queue_place import QueuePlace, queue_place
from workbench.run_state import RunState

WORKING = {"w1": RunState("running", wall_s=40.0, eta_s=900.0), "w2": RunState("running", wall_s=10.0, eta_s=30.0)}
WAITING = {f"q{number}": RunState("queued", created=f"2026-01-01T00:00:0{9 - number}") for number in range(1, 6)}
TAKES_S = {"w1": 100.0, "w2": 100.0, "q1": 50.0, "q2": 20.0, "q3": 70.0, "q4": 10.0, "q5": 30.0}
ORDER = ["q5", "q4", "q3", "q2", "q1"]
"""The oldest first."""


def started_at(cores: int) -> dict[str, float]:
    """When each waiting run starts, by ticking through the seconds; w1 takes 60 s more, w2 at most 30 s."""
    left = {"w1": 60.0, "w2": 30.0}
    queue, started = list(ORDER), {}
    for second in itertools.count():
        left = {run: seconds for run, seconds in left.items() if seconds > 0.0}
        while queue and len(left) < cores:
            run = queue.pop(0)
            started[run], left[run] = float(second), TAKES_S[run]
        if not queue:
            return started
        left = {run: seconds - 1.0 for run, seconds in left.items()}
    raise AssertionError


@pytest.mark.parametrize("cores", [2, 3, 4, 9])
def test_a_run_starts_when_those_before_it_leave_a_core(cores: int) -> None:
    wanted = started_at(cores)
    for number, run in enumerate(ORDER):
        place = queue_place(run, {**WORKING, **WAITING}, cores, TAKES_S.get)
        assert place == QueuePlace(number + 1, 5, wanted[run]), run


def test_nothing_is_promised_while_one_before_it_is_unknown() -> None:
    states = {**WORKING, **WAITING}
    assert queue_place("q3", states, 2, lambda run: None if run == "q4" else TAKES_S[run]) == QueuePlace(3, 5)
    known = queue_place("q4", states, 2, lambda run: None if run == "q1" else TAKES_S[run])
    assert known is not None and known.starts_s == 60.0
    unknown = {**WAITING, "w": RunState("running")}
    assert queue_place("q5", unknown, 1, lambda _run: None) == QueuePlace(1, 5)


def test_a_run_of_a_cluster_and_one_that_works_have_no_place() -> None:
    states = {**WORKING, "r": RunState("queued", engine="ray", created="2025"), "q": RunState("queued", created="2026")}
    assert queue_place("r", states, 2, TAKES_S.get) is None
    assert queue_place("w1", states, 2, TAKES_S.get) is None
    place = queue_place("q", states, 2, TAKES_S.get)
    assert place is not None and (place.place, place.waiting) == (1, 1)
