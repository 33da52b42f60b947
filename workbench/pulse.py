"""The pace of a training process: when it counts as stalled, and how much of its time goes into saving."""

from __future__ import annotations

LEAST_PATIENCE_S = 120.0
"""A training that has given signs before never counts as stalled sooner."""
SAVING_SHARE = 0.05
"""Largest share of a training's time that goes into checkpoints; on most disks every epoch gets one."""


class Pulse:
    """Kept by the training itself, by a monotonic clock [s]."""

    def __init__(self, began_s: float) -> None:
        self._began_s = self._beat_s = began_s
        self._longest_s = 0.0
        self._saving_s = 0.0

    def beat(self, now_s: float) -> float:
        """A sign of life; how long to wait for the next one [s]: ten times the longest pause so far."""
        self._longest_s = max(self._longest_s, now_s - self._beat_s)
        self._beat_s = now_s
        return max(10.0 * self._longest_s, LEAST_PATIENCE_S)

    def worth_saving(self, now_s: float) -> bool:
        """Whether saving has taken no more than its share so far; the first time it is worth it."""
        return self._saving_s <= SAVING_SHARE * (now_s - self._began_s)

    def saved(self, duration_s: float) -> None:
        """A checkpoint took so long."""
        self._saving_s += duration_s
