"""Calibration tables: lines with a value, its interval, what is accepted and the verdict; how far off all are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from agents.evaluation import WILSON_Z

Interval = tuple[float, float]
Verdict = Literal["ok", "not ok", "undecided"]

UNMEASURED: Final = 1.0
"""Shortfall of a value that could not be measured (no flight arrived): as bad as a share that is wholly wrong."""


@dataclass(frozen=True)
class Target:
    """One line of a calibration table."""

    name: str
    value: float
    """What was measured; NaN when there was nothing to measure."""
    low: float
    high: float
    """Accepted are values from low to high, both included."""
    ci95: Interval = (math.nan, math.nan)
    """95 % interval of the value; NaN where too little was measured to give one."""
    scale: float = 1.0
    """What counts as much as a whole share in the shortfall, in the unit of the value."""

    @property
    def ok(self) -> bool:
        """Whether the measured value is accepted."""
        return self.low <= self.value <= self.high

    @property
    def verdict(self) -> Verdict:
        """`ok` or `not ok` where the whole interval says so; `undecided` where more episodes could turn it."""
        low, high = self.ci95
        if self.ok and self.low <= low and high <= self.high:
            return "ok"
        if math.isnan(self.value) or (not self.ok and (high < self.low or low > self.high)):
            return "not ok"
        return "undecided"

    @property
    def shortfall(self) -> float:
        """Distance from the value to what is accepted, in `scale`; 0 exactly when it is accepted."""
        if math.isnan(self.value):
            return UNMEASURED
        return max(self.low - self.value, self.value - self.high, 0.0) / self.scale

    @property
    def doubt(self) -> float:
        """How far the interval reaches out of what is accepted, in `scale`: the smaller, the safer."""
        if math.isnan(sum(self.ci95)):
            return UNMEASURED
        return (max(self.low - self.ci95[0], 0.0) + max(self.ci95[1] - self.high, 0.0)) / self.scale

    def to_json(self) -> dict[str, Any]:
        """The line as plain JSON values."""
        figures = {"name": self.name, "value": self.value, "low": self.low, "high": self.high, "ok": self.ok}
        return figures | {"ci95": list(self.ci95), "verdict": self.verdict}


@dataclass(frozen=True)
class LeftOut:
    """A line of the table that a scenario has no use for, and why."""

    name: str
    reason: str

    def to_json(self) -> dict[str, str]:
        """The line as plain JSON values."""
        return {"name": self.name, "reason": self.reason}


@dataclass(frozen=True)
class Calibration:
    """The lines of the calibration tables for one scenario."""

    scenario: str
    episodes: int
    seed: int
    targets: tuple[Target, ...]
    left_out: tuple[LeftOut, ...]
    spared: int = 0
    """Groups of lines left unmeasured behind a line that was surely missed."""

    @property
    def ok(self) -> bool:
        """Whether every measured value is accepted."""
        return all(target.ok for target in self.targets)

    @property
    def missed(self) -> bool:
        """Whether a line is surely missed."""
        return any(target.verdict == "not ok" for target in self.targets)

    @property
    def shortfall(self) -> float:
        """How far the values are from all targets, summed over the lines: 0 exactly when all are ok.

        A share counts with the points it lies outside, 0.01 each; other values in the scale of their line.
        """
        return sum(target.shortfall for target in self.targets)

    @property
    def doubt(self) -> float:
        """How far the 95 % intervals reach out of what is accepted, summed over the lines."""
        return sum(target.doubt for target in self.targets)

    def to_json(self) -> dict[str, Any]:
        """The tables as plain JSON values."""
        lines = {"targets": [t.to_json() for t in self.targets], "left_out": [line.to_json() for line in self.left_out]}
        return {"scenario": self.scenario, "episodes": self.episodes, "seed": self.seed,
                "shortfall": self.shortfall, **lines}  # fmt: skip


def mean_interval(values: ArrayLike, z: float = WILSON_Z) -> Interval:
    """Interval of the mean of independent values `[N]`, 95 % by default: mean ± z s / √N; NaN for fewer than two."""
    sample = np.asarray(values, dtype=np.float64)
    if len(sample) < 2:
        return math.nan, math.nan
    mean, half = float(sample.mean()), z * float(sample.std(ddof=1)) / math.sqrt(len(sample))
    return mean - half, mean + half
