"""Pictures of Fig. 8, 9, 12 and 13, drawn from result sets."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from layouts.paper_azimuth import AzimuthPanel, azimuth_figure
from layouts.paper_bars import Bars, policy_bars
from layouts.paper_curves import Band, Panel, ablation_figure, baseline_figure
from layouts.paper_sheet import picture
from workbench.reproduce.paper_numbers import EXPERT_ON_TARGET
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import LABELS, TASK_LABELS, TRAINED_FOR
from workbench.reproduce.result_file import to_text
from workbench.reproduce.result_set import Curve, ResultSet
from workbench.reproduce.scorecard import seeds_there
from workbench.reproduce.seed_curves import Quantity, summary
from workbench.run_files import write_bytes


def draw(result: ResultSet, path: Path) -> bool:
    """Write the picture of an item as .png; returns False for one that has none (Table 4) or nothing to show."""
    if result.item == "fig12" and result.flights:
        figure = _fig12(result)
    elif result.item == "fig13" and result.numbers:
        figure = _fig13(result)
    elif result.item in ("fig8", "fig9") and result.curves:
        panels = [_panel(result, task) for task in (CHAIN[1:] if result.item == "fig8" else CHAIN[-1:])]
        words = _curves_caption(result)
        figure = ablation_figure(panels, words) if result.item == "fig8" else baseline_figure(panels[0], words)
    else:
        return False
    write_bytes(path, picture(figure, "png", source_of(result)))
    return True


def source_of(result: ResultSet) -> str:
    """What stands in the picture's file: which result set, to the byte, it was drawn from."""
    return f"{result.item}.json sha256 {hashlib.sha256(to_text(result).encode()).hexdigest()}"


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
    return Band(variant, LABELS[variant], steps, interval.value, interval.low, interval.high, seeds)


def _curves_caption(result: ResultSet) -> str:
    seeds = ", ".join(f"{LABELS[variant]} {seeds_there(result, variant)}" for variant in TRAINED_FOR[result.item])
    before = "SubMas-RL has learned the easier tasks before; steps are those of this task.\n"
    before = before if result.item == "fig9" else ""
    return (
        "Held-out evaluations while training: interquartile mean over seeds and its 95 % bootstrap interval.\n"
        f"Thin: every seed, with a dot where its stage ended; its last value counts on.\n"
        f"{before}Profile {result.profile}, scenario {result.scenario}. Seeds: {seeds}."
    )


def _fig12(result: ResultSet) -> Figure:
    panels = []
    for letter, flight in zip("ab", result.flights, strict=True):
        angles = {
            missile.number: np.array([np.nan if a is None else a for a in missile.azimuth_deg])
            for missile in flight.missiles
        }
        panels.append(AzimuthPanel(f"({letter}) {LABELS[flight.variant]}", np.array(flight.time_s), angles))
    first = result.flights[0]
    beams = " and ".join(f"{f.beam_share:.0%} ({f.policy})".replace("%", " %") for f in result.flights)
    caption = (
        f"The same engagement, the first in which both evade every missile and arrive (scenario {result.scenario}, "
        f"seed {first.seed}, episode {first.episode}).\n"
        f"The closest missile is within 15° of ±90° for {beams} of the time in which one flies."
    )
    return azimuth_figure(panels, caption)


def _fig13(result: ResultSet) -> Figure:
    bars = [_bars(result, "submas", "SubMas-RL, each task's own policy"), _bars(result, "expert", "dragging expert")]
    dots = _bars(result, "submas-target", "SubMas-RL, the target's policy")
    tasks = [TASK_LABELS[task].replace(" task", "\ntask") for task in CHAIN]
    caption = (
        f"{result.episodes} episodes of each policy on each task, from the same initial states; lines: Wilson 95 % "
        f"intervals. Scenario {result.scenario}.\n"
        "Source task k has k missiles less than the target task. In source task 4 SubMas-RL is the navigation expert "
        "(section 4.1).\nThe paper tells two of these numbers: 94.8 % and 62.1 % on the target task."
    )
    return policy_bars(tasks, bars, dots, {len(CHAIN) - 1: EXPERT_ON_TARGET}, caption)


def _bars(result: ResultSet, variant: str, label: str) -> Bars:
    found = [next(iter(result.reported(variant, task)), None) for task in CHAIN]
    return Bars(
        algorithm=variant,
        label=label,
        returns=[number and number.mean_return for number in found],
        success=[number and number.success_rate for number in found],
        interval=[number and number.success_ci95 for number in found],
    )
