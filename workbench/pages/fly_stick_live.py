"""A flight by hand on the wall clock: time goes on as fast as the person chose, the world steps along."""

from __future__ import annotations

import math

from workbench.branch_stick import Stick

LAG_S = 0.5
"""Wall time that one call makes up for: after a pause of the machine the flight goes on, it does not leap."""


class LiveFlight:
    """A stick whose world is at most one decision step ahead of what is shown, so that 1× moves smoothly."""

    def __init__(self, stick: Stick) -> None:
        self.stick = stick
        self.time_s = stick.time_s
        """What is shown [s]."""

    @property
    def over(self) -> bool:
        """Whether the end of the flight has been shown."""
        return self.stick.over and self.time_s >= self.stick.time_s

    def advance(self, passed_s: float, speed: float, heading_deg: int) -> None:
        """Go on by some wall time [s], steering towards a heading at every decision that falls into it."""
        if not math.isfinite(passed_s) or passed_s <= 0.0:
            return
        self.time_s += min(passed_s, LAG_S) * speed
        while self.stick.time_s < self.time_s and not self.stick.over:
            self.stick.step(heading_deg)
        self.time_s = min(self.time_s, self.stick.time_s)
