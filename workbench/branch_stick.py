"""The stick in a person's hand: a world of one lane that is flown step by step from a moment of a recorded flight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from layouts.branch_bodies import Pose
from sim.trajectory import Trajectory
from sim.world import TRACE_AIRCRAFT, TRACE_MISSILE, Fate, Outcome, World
from workbench.branch import Branch, check_moment, turn_towards


@dataclass(frozen=True)
class Sight:
    """What a person at the stick sees at one decision, angles as the dial draws them: from the x axis to the left."""

    time_s: float
    heading_rad: float
    exit_rad: float
    """Direction of the exit."""
    missiles: tuple[tuple[int, float, float], ...]
    """Number, direction [rad] and range [m] of each missile that is seen in flight."""
    speed_m_s: float


class Stick:
    """One live flight; `step` moves it by one decision step, under a millisecond.

    Args:
        original: the flight that is left.
        branch: where it is left, and headings already flown by hand, which are flown again; its policy is ignored.

        state: initial state `[1, 10 + ...]` the original was flown from, if it was not its episode's own.

    Raises:
        BranchError: the original is over at that moment.
    """

    def __init__(self, original: Trajectory, branch: Branch, state: NDArray[np.float32] | None = None) -> None:
        check_moment(original, branch)
        self.branch = branch
        self._rules = original.task.scenario.rules
        self._world = World(original.task, lanes=1, seed=original.seed)
        self._world.reset(episodes=[original.episode], states=state)
        self._world.trace()
        for turn in original.action_rad[: branch.step]:
            self._world.step([turn])
        self.headings_deg: list[int] = []
        self._rows = [self._world.traced(0)[-1:] if branch.step else self._world.snapshot(0)]
        for heading in branch.headings_deg:
            self.step(heading)

    @property
    def over(self) -> bool:
        """Whether the flight has ended."""
        return bool(self._world.outcome[0] != Outcome.FLYING)

    @property
    def start_s(self) -> float:
        """Where the original was left [s]."""
        return self.branch.step * self._rules.step_s

    @property
    def time_s(self) -> float:
        """How far it has been flown [s]."""
        return (self.branch.step + len(self.headings_deg)) * self._rules.step_s

    def step(self, heading_deg: int) -> None:
        """Steer towards this heading [0, 359] for one decision step; nothing happens when the flight is over."""
        if self.over:
            return
        turn = turn_towards(heading_deg, self._world.observation[0])
        self._world.step([turn])
        self.headings_deg.append(heading_deg)
        self._rows.append(self._world.traced(0))

    def flown(self, policy: str = "") -> Branch:
        """The branch as flown so far, handed over to `policy` (none: the last heading is held)."""
        return Branch(self.branch.of, self.branch.step, tuple(self.headings_deg), policy)

    def sight(self) -> Sight:
        """What is seen now."""
        observation = self._world.observation[0].astype(float)
        layout, heading = self._world.task.layout, float(observation[2])
        blocks = [(missile, *observation[layout.block(missile)]) for missile in layout.missiles]
        seen = tuple((missile, heading + azimuth, distance) for missile, distance, azimuth in blocks if distance >= 0.0)
        speed = float(self._world.aircraft["speed"][0, 0])
        return Sight(self.time_s, heading, heading + float(observation[6]), seen, speed)

    def poses(self, time_s: float) -> dict[str, Pose]:
        """Bodies in flight at a time [s] between the moment of leaving and `time_s`, by name as in a replay."""
        row = self._row(time_s)
        poses = {
            name: Pose(row[first : first + 3], *(float(row[first + c]) for c in (5, 4, 6)))
            for name, first in (("evader", 0), ("interceptor", TRACE_AIRCRAFT))
        }
        for missile in self._world.task.missiles:
            block = row[2 * TRACE_AIRCRAFT + TRACE_MISSILE * (missile - 1) :][:TRACE_MISSILE]
            if block[6] == Fate.FLYING:
                poses[f"missile_{missile}"] = _missile_pose(block)
        return poses

    def _row(self, time_s: float) -> NDArray[np.float64]:
        """The record nearest to a time: row k of the decision step it falls into."""
        substeps = round((time_s - self.start_s) / self._rules.step_s * self._rules.substeps)
        step, within = divmod(max(substeps - 1, 0), self._rules.substeps)
        rows = self._rows[min(step + 1, len(self._rows) - 1) if substeps > 0 else 0]
        return rows[min(within, len(rows) - 1)].astype(float)


def _missile_pose(block: NDArray[np.float64]) -> Pose:
    velocity = block[3:6]
    heading, pitch = np.arctan2(velocity[1], velocity[0]), np.arctan2(velocity[2], np.hypot(*velocity[:2]))
    return Pose(block[:3], float(heading), float(pitch), 0.0)
