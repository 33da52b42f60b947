"""The picture of the study of stability: held-out success of every seed, a panel for each remedy taken away."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Final

import numpy as np
from matplotlib.axes import Axes

from layouts import paper_sheet
from layouts.paper_sheet import FAINT, name, plain, sheet
from layouts.theme import FAILURE, POLICY_A

ACROSS: Final = 4
PANEL_IN: Final = (2.9, 1.9)
TITLE_WIDTH: Final = 36
"""Letters that fit over a panel."""


@dataclass(frozen=True)
class Panel:
    """One remedy."""

    title: str
    seeds: Sequence[tuple[Sequence[int], Sequence[float]]]
    """Epochs and success rates of every seed."""
    epsilon: Sequence[float]
    """Share of policy reuse at the first seed's epochs: how much of the guide was left."""


def picture(panels: Sequence[Panel]) -> bytes:
    """The picture as PNG; equal panels give equal bytes."""
    down = -(-len(panels) // ACROSS)
    width, height = ACROSS * PANEL_IN[0], down * PANEL_IN[1] + 1.15
    seeds = max(len(panel.seeds) for panel in panels)
    figure = sheet(
        "What each remedy is good for",
        f"Held-out success on the target task while the guide fades; a line for each of {seeds} seeds, the median "
        "thick. Dashed: ε, the share of steps the guide may fly.",
        (width, height),
    )
    figure.subplots_adjust(
        left=0.5 / width, right=1 - 0.15 / width, top=1 - 0.75 / height, bottom=0.7 / height, hspace=0.6, wspace=0.16
    )
    axes = figure.subplots(down, ACROSS, sharex=True, sharey=True, squeeze=False).ravel()
    for place, panel in zip(axes, panels, strict=False):
        _draw(place, panel)
    for place in axes[len(panels) :]:
        place.set_visible(False)
    return paper_sheet.picture(figure, "png")


def _draw(axes: Axes, panel: Panel) -> None:
    plain(axes)
    name(axes, fill(panel.title, TITLE_WIDTH))
    axes.title.set_fontsize(8.5)
    for epochs, success in panel.seeds:
        axes.plot(epochs, success, color=POLICY_A, linewidth=0.9, alpha=0.55)
    shared = min(len(success) for _, success in panel.seeds)
    middle = np.median([success[:shared] for _, success in panel.seeds], axis=0)
    axes.plot(panel.seeds[0][0][:shared], middle, color=POLICY_A, linewidth=2.2)
    axes.plot(panel.seeds[0][0], panel.epsilon, color=FAILURE, linewidth=1.0, linestyle="--")
    axes.set_ylim(-0.03, 1.03)
    axes.set_xlabel("epoch", fontsize=8, color=FAINT)
