"""Which moments an animation shows: all of the flight, and most of them while missiles fly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.trajectory import Trajectory

SLOWER = 6.0
"""So many times slower runs the clock while a missile flies."""

EASE_S = 12.0
"""Seconds of the flight in which the clock changes its pace."""

GRID_S = 0.5


def frame_times(flights: Sequence[Trajectory], frames: int) -> NDArray[np.float64]:
    """Times [frames] of the flight, ascending from 0 to the end of the longer one."""
    end_s = max(flight.duration_s for flight in flights)
    grid = np.linspace(0.0, end_s, max(2, round(end_s / GRID_S) + 1))
    pace = 1.0 + (SLOWER - 1.0) * _eased(engaged(flights, grid), end_s / (len(grid) - 1))
    shown = np.append(0.0, np.cumsum((pace[1:] + pace[:-1]) / 2))
    return np.interp(np.linspace(0.0, shown[-1], frames), shown, grid)


def engaged(flights: Sequence[Trajectory], time_s: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a missile of any of the flights is in the air, at each time."""
    flying = np.zeros(len(time_s), dtype=bool)
    for flight in flights:
        for missile in flight.missiles:
            end_s = missile.end_s if np.isfinite(missile.end_s) else flight.duration_s
            flying |= (time_s >= missile.launch_s) & (time_s <= end_s)
    return flying


def _eased(flying: NDArray[np.bool_], spacing_s: float) -> NDArray[np.float64]:
    width = 2 * max(1, round(EASE_S / 2 / max(spacing_s, GRID_S / 2))) + 1
    padded = np.pad(flying.astype(float), width // 2, mode="edge")
    return np.convolve(padded, np.hanning(width + 2)[1:-1] / np.hanning(width + 2).sum(), mode="valid")
