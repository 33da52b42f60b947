"""What the figures are drawn from: a result set in the terms of `layouts`, the same for pictures and for pages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from layouts.paper_panels import AzimuthPanel, Band, Bars, Panel
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import LABELS, TASK_LABELS, TRAINED_FOR
from workbench.reproduce.result_set import Curve, ResultSet
from workbench.reproduce.seed_curves import Quantity, summary


def curve_panels(result: ResultSet) -> list[Panel]:
    """Learning curves task by task: the four that are trained (Fig. 8), or the target alone (Fig. 9)."""
    return [_panel(result, task) for task in (CHAIN[1:] if result.item == "fig8" else CHAIN[-1:])]


def azimuth_panels(result: ResultSet) -> list[AzimuthPanel]:
    """Azimuth curves of every flight (Fig. 12)."""
    panels = []
    for letter, flight in zip("ab", result.flights, strict=True):
        angles = {
            missile.number: np.array([np.nan if a is None else a for a in missile.azimuth_deg])
            for missile in flight.missiles
        }
        panels.append(AzimuthPanel(f"({letter}) {LABELS[flight.variant]}", np.array(flight.time_s), angles))
    return panels


def policy_bars_of(result: ResultSet) -> tuple[list[Bars], Bars]:
    """Each task's own policy and the expert as bars, the target's policy as marks (Fig. 13)."""
    bars = [_bars(result, "submas", "SubMas-RL, each task's own policy"), _bars(result, "expert", "dragging expert")]
    return bars, _bars(result, "submas-target", "SubMas-RL, the target's policy")


def _panel(result: ResultSet, task: str) -> Panel:
    bands: dict[Quantity, list[Band]] = {"mean_return": [], "success_rate": []}
    for variant in TRAINED_FOR[result.item]:
        curves = [c for c in result.curves if (c.variant, c.task) == (variant, task) and c.env_steps]
        if curves:
            for quantity, drawn in bands.items():
                drawn.append(_band(variant, curves, quantity))
    return Panel(TASK_LABELS[task], tuple(bands["mean_return"]), tuple(bands["success_rate"]))


def _band(variant: str, curves: Sequence[Curve], quantity: Quantity) -> Band:
    steps, interval = summary(curves, quantity)
    seeds = tuple((np.array(c.env_steps, float), np.array(getattr(c, quantity), float)) for c in curves)
    names = tuple(f"seed {c.seed}" for c in curves)
    return Band(variant, LABELS[variant], steps, interval.value, interval.low, interval.high, seeds, names)


def _bars(result: ResultSet, variant: str, label: str) -> Bars:
    found = [next(iter(result.reported(variant, task)), None) for task in CHAIN]
    return Bars(
        algorithm=variant,
        label=label,
        returns=[number and number.mean_return for number in found],
        success=[number and number.success_rate for number in found],
        interval=[number and number.success_ci95 for number in found],
    )
