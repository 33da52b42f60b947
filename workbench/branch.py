"""A branch of a recorded engagement: the same flight up to one of its moments, then flown on by somebody else."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from layouts.captions import flown_on_text
from sim.errors import UsageError
from sim.geometry import wrap_to_pi
from sim.trajectory import Act, Departure, Event, Trajectory, fly

FULL_CIRCLE_DEG = 360
NAME_LENGTH = 24
"""Characters of a policy's name, its last ones, in the list of events."""
LIMIT_RAD = math.pi / 2
"""Largest turning angle of an action (§2.3)."""


class BranchError(UsageError):
    """A branch that cannot be flown, or text that is none."""


@dataclass(frozen=True)
class Branch:
    """Where a flight is left, and who flies on: by hand first, if at all, then a policy.

    Headings by hand are whole degrees, one per decision step, counted from the x axis to the left. A turn is computed
    from the heading that is asked for and the one that is flown, so the same headings fly the same bits again.
    """

    of: str
    """Letter of the flight that is left: A or B."""
    step: int
    """Decision step from which on somebody else flies: with a step of 1 s, the second."""
    headings_deg: tuple[int, ...] = ()
    """Headings chosen by hand, 0 to 359, the first for `step`; empty when a policy flies on at once."""
    policy: str = ""
    """POLICY that flies on after the headings; empty: the last heading is held."""

    def __post_init__(self) -> None:
        """Reject a branch that nobody flies.

        Raises:
            BranchError: neither a heading nor a policy, a heading that is none, or a negative step.
        """
        wrong = next((h for h in self.headings_deg if not 0 <= h < FULL_CIRCLE_DEG), None)
        if wrong is not None:
            raise BranchError(f"heading {wrong} is not a whole number of degrees from 0 to 359")
        if self.step < 0 or not (self.headings_deg or self.policy):
            raise BranchError(f"a branch at step {self.step} needs a step from 0 on and headings or a policy")

    @property
    def by_hand(self) -> bool:
        """Whether a person flew some of it."""
        return bool(self.headings_deg)

    @property
    def hand_ends(self) -> int:
        """Decision step at which the headings chosen by hand end."""
        return self.step + len(self.headings_deg)


def fly_branch(
    original: Trajectory,
    branch: Branch,
    act: Act | None,
    record_every: int = 1,
    state: NDArray[np.float32] | None = None,
) -> Trajectory:
    """Fly the original's turns up to the branch's step, then the headings, then the policy; 0.5 s in a typical flight.

    Up to that moment it is the original bit for bit, and with the policy that flew the original it is the original.

    Args:
        original: the flight that is left, recorded in any density.
        branch: where it is left and which headings are flown by hand.
        act: the branch's policy bound to the original's task; None holds the last heading.
        record_every: keep every n-th substep; take the original's for records at the same times.
        state: initial state `[1, 10 + ...]` the original was flown from, if it was not its episode's own.

    Raises:
        BranchError: the original is over at that moment.
    """
    check_moment(original, branch)
    decide = _Playback(original.action_rad, branch, act)
    flight = fly(original.task, decide, caption(original, branch), original.seed, original.episode, record_every, state)
    left = departure(original, branch)
    events = sorted((*flight.events, *_handings(left, flight.duration_s)), key=lambda event: event.time_s)
    return replace(flight, departure=left, events=tuple(events))


def departure(original: Trajectory, branch: Branch) -> Departure:
    """Where a branch leaves its original and who flies on, as it stays with the flight."""
    by_hand_s = len(branch.headings_deg) * original.task.scenario.rules.step_s
    time_s = moment_s(original, branch)
    return Departure(branch.of, original.policy, time_s, branch.headings_deg, by_hand_s, branch.policy)


def check_moment(original: Trajectory, branch: Branch) -> None:
    """Raise `BranchError` unless the original still flies at the branch's step."""
    steps = len(original.action_rad)
    if branch.step >= steps:
        raise BranchError(
            f"flight {branch.of} cannot be left at step {branch.step}, it is over; legal are steps 0 to {steps - 1}"
        )


def moment_s(original: Trajectory, branch: Branch) -> float:
    """Time at which the branch leaves the original [s]."""
    return branch.step * original.task.scenario.rules.step_s


def branch_of(flight: Trajectory) -> Branch | None:
    """The branch that a flight flew, to be flown again; None for a flight of its own."""
    left = flight.departure
    if left is None:
        return None
    return Branch(left.of, round(left.time_s / flight.task.scenario.rules.step_s), left.headings_deg, left.then)


def caption(original: Trajectory, branch: Branch) -> str:
    """Who flew a branch, as a policy's name in captions and files."""
    return f"{original.policy}, from {moment_s(original, branch):g} s {flown_on_text(departure(original, branch))}"


def _handings(left: Departure, end_s: float) -> list[Event]:
    """The moment itself, and that at which a person handed over, as things that happened."""
    heir = left.then[-NAME_LENGTH:]
    events = [Event(left.time_s, "branch", 0, f"leaves {left.of}: {'by hand' if left.headings_deg else heir}")]
    over_s = left.time_s + left.by_hand_s
    handed = bool(left.headings_deg) and over_s < end_s
    words = f"handed over to {heir}" if left.then else "heading held"
    return [*events, Event(over_s, "branch", 0, words)] if handed else events


def turn_towards(heading_deg: int, observation: NDArray[Any]) -> float:
    """Turning angle [rad] from the heading of one observation `[d]` to this one, within one action's limit."""
    turn = float(wrap_to_pi(math.radians(heading_deg) - float(observation[2])))
    return min(max(turn, -LIMIT_RAD), LIMIT_RAD)


class _Playback:
    """The turns of the original, then the headings, then the policy's, as a policy that counts its steps."""

    def __init__(self, turns: NDArray[np.float64], branch: Branch, act: Callable[[Any], Any] | None) -> None:
        self._turns, self._branch, self._act = turns, branch, act
        self._count = itertools.count()

    def __call__(self, observation: NDArray) -> NDArray:
        step, branch = next(self._count), self._branch
        # Asked from the start: a policy that draws or remembers flies on as if it had flown all along.
        own = None if self._act is None else self._act(observation)
        if step < branch.step:
            return self._turns[step : step + 1]
        if step < branch.hand_ends or own is None:
            heading = branch.headings_deg[min(step, branch.hand_ends - 1) - branch.step]
            return np.array([turn_towards(heading, observation[0])])
        return own
