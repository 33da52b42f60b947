"""Survival as colours and cells, for maps on pages and in pictures alike; nothing here draws."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]

SHOT_DOWN = "#e69f00"
SURVIVED = "#1f5fa8"
"""Orange and blue stay apart for every kind of colour vision, and in grey: one is light, the other dark."""
UNDECIDED = "#f3f1ec"
STOPS = (SHOT_DOWN, UNDECIDED, SURVIVED)
"""Colours of a share of survivors of 0, 1/2 and 1; those between are mixed of their neighbours."""


@cache  # a map has a thousand cells and few shares
def survival_colour(share: float) -> str:
    """Colour `#rrggbb` of a share of survivors in [0, 1]."""
    channels = np.array([[int(stop[at : at + 2], 16) for at in (1, 3, 5)] for stop in STOPS], dtype=float)
    mixed = [np.interp(share, np.linspace(0.0, 1.0, len(STOPS)), channel) for channel in channels.T]
    return "#" + "".join(f"{round(channel):02x}" for channel in mixed)


def edges(centres: Values) -> Values:
    """Borders `[n + 1]` of cells with these ascending centres `[n]`: half way between neighbours."""
    middles = (centres[1:] + centres[:-1]) / 2.0
    return np.concatenate([[2.0 * centres[0] - middles[0]], middles, [2.0 * centres[-1] - middles[-1]]])
