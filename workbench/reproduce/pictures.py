"""Pictures of Fig. 8, 9, 12 and 13, drawn from result sets."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Literal

from matplotlib.figure import Figure

from layouts.paper_azimuth import azimuth_figure
from layouts.paper_bars import policy_bars
from layouts.paper_curves import ablation_figure, baseline_figure
from layouts.paper_sheet import picture
from workbench.reproduce.drawings import azimuth_panels, curve_panels, policy_bars_of
from workbench.reproduce.paper_numbers import EXPERT_ON_TARGET
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import LABELS, TASK_LABELS, TRAINED_FOR
from workbench.reproduce.result_file import to_text
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.scorecard import seeds_there
from workbench.run_files import write_bytes


def draw(result: ResultSet, path: Path) -> bool:
    """Write the picture of an item as .png; returns False for one that has none (Table 4) or nothing to show."""
    content = picture_of(result, "png")
    if content is not None:
        write_bytes(path, content)
    return content is not None


def picture_of(result: ResultSet, kind: Literal["png", "svg"]) -> bytes | None:
    """The picture of an item as the content of a file; None for one that has none (Table 4) or nothing to show."""
    if result.item == "fig12" and result.flights:
        figure = _fig12(result)
    elif result.item == "fig13" and result.numbers:
        figure = _fig13(result)
    elif result.item in ("fig8", "fig9") and result.curves:
        panels, words = curve_panels(result), _curves_caption(result)
        figure = ablation_figure(panels, words) if result.item == "fig8" else baseline_figure(panels[0], words)
    else:
        return None
    return picture(figure, kind, source_of(result))


def source_of(result: ResultSet) -> str:
    """What stands in the picture's file: which result set, to the byte, it was drawn from."""
    return f"{result.item}.json sha256 {hashlib.sha256(to_text(result).encode()).hexdigest()}"


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
    first = result.flights[0]
    beams = " and ".join(f"{f.beam_share:.0%} ({f.policy})".replace("%", " %") for f in result.flights)
    caption = (
        f"The same engagement, the first in which both evade every missile and arrive (scenario {result.scenario}, "
        f"seed {first.seed}, episode {first.episode}).\n"
        f"The closest missile is within 15° of ±90° for {beams} of the time in which one flies."
    )
    return azimuth_figure(azimuth_panels(result), caption)


def _fig13(result: ResultSet) -> Figure:
    bars, dots = policy_bars_of(result)
    tasks = [TASK_LABELS[task].replace(" task", "\ntask") for task in CHAIN]
    caption = (
        f"{result.episodes} episodes of each policy on each task, from the same initial states; lines: Wilson 95 % "
        f"intervals. Scenario {result.scenario}.\n"
        "Source task k has k missiles less than the target task. In source task 4 SubMas-RL is the navigation expert "
        "(section 4.1).\nThe paper tells two of these numbers: 94.8 % and 62.1 % on the target task."
    )
    return policy_bars(tasks, bars, dots, {len(CHAIN) - 1: EXPERT_ON_TARGET}, caption)
