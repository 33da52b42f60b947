"""Learning curves of several algorithms over seeds: Fig. 8 (ablations, four tasks) and Fig. 9 (baselines)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from layouts.paper_inks import ink
from layouts.paper_panels import Band, Panel
from layouts.paper_sheet import FAINT, INK, name, plain, sheet


def ablation_figure(panels: Sequence[Panel], caption: str) -> Figure:
    """Fig. 8: episode return above and success rate below, a column for every task."""
    return _curves(panels, "Fig. 8  Ablations while they learn", caption, (13.6, 6.6))


def baseline_figure(panel: Panel, caption: str) -> Figure:
    """Fig. 9: episode return above and success rate below, on the target task."""
    return _curves([panel], "Fig. 9  SubMas-RL and learning from scratch", caption, (7.6, 6.6))


def _curves(panels: Sequence[Panel], title: str, caption: str, size_in: tuple[float, float]) -> Figure:
    figure = sheet(title, caption, size_in)
    width, height = size_in
    below_in = 0.68 + 0.18 * (caption.count("\n") + 1)
    grid = figure.add_gridspec(
        2, len(panels), left=0.75 / width, right=1.0 - 0.2 / width, top=1.0 - 1.0 / height,
        bottom=below_in / height, hspace=0.12, wspace=0.16,
    )  # fmt: skip
    drawn: list[Axes] = []
    for column, panel in enumerate(panels):
        upper = figure.add_subplot(grid[0, column])
        lower = figure.add_subplot(grid[1, column], sharex=upper)
        name(upper, panel.title)
        upper.tick_params(labelbottom=False)
        for axes, bands in ((upper, panel.returns), (lower, panel.success)):
            _draw(axes, bands)
            plain(axes)
        lower.set(xlabel="environment steps [million]", ylim=(-0.03, 1.03))
        lower.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
        drawn += [upper, lower]
    drawn[0].set_ylabel("episode return")
    drawn[1].set_ylabel("success rate")
    _legend(figure, panels, size_in)
    return figure


def _draw(axes: Axes, bands: Sequence[Band]) -> None:
    """Every seed thin, the band of the interval, and the summary on top; SubMas-RL above all."""
    if not bands:
        axes.text(0.5, 0.5, "not run yet", transform=axes.transAxes, ha="center", color=FAINT)
    for band in sorted(bands, key=lambda band: band.algorithm == "submas"):
        colour = ink(band.algorithm)
        for steps, values in band.seeds:
            axes.plot(steps / 1e6, values, color=colour, linewidth=0.6, alpha=0.35)
            # Where a stage ended: a seed that has passed counts on with its last value.
            axes.plot(steps[-1:] / 1e6, values[-1:], "o", color=colour, markersize=2.5, alpha=0.5)
        if np.isfinite(band.low).any():
            axes.fill_between(band.steps / 1e6, band.low, band.high, color=colour, alpha=0.16, linewidth=0)
        # A single evaluation has no line.
        style = {"marker": "o"} if len(band.steps) == 1 else {}
        axes.plot(band.steps / 1e6, band.value, color=colour, linewidth=2.0, solid_capstyle="round", **style)


def _legend(figure: Figure, panels: Sequence[Panel], size_in: tuple[float, float]) -> None:
    names = {band.algorithm: band.label for panel in panels for band in panel.success}
    entries = [Line2D([], [], color=ink(algorithm), linewidth=2.5, label=label) for algorithm, label in names.items()]
    if entries:
        figure.legend(
            handles=entries, loc="upper left", bbox_to_anchor=(0.12 / size_in[0], 1.0 - 0.4 / size_in[1]),
            ncols=len(entries), frameon=False, fontsize=9.5, labelcolor=INK, handlelength=1.6, columnspacing=1.6,
        )  # fmt: skip
