"""The picture of one stage that has learned: held-out success of every epoch, and how much of the guide was left."""

from __future__ import annotations

from collections.abc import Sequence

from layouts import paper_sheet
from layouts.paper_sheet import FAINT, INK, plain, sheet
from layouts.theme import FAILURE, POLICY_A

SIZE_IN = (9.6, 3.9)


def picture(title: str, caption: str, success: Sequence[float], epsilon: Sequence[float], kept: int) -> bytes:
    """The picture as PNG; equal numbers give equal bytes.

    Args:
        title: what was trained.
        caption: one line below.
        success: held-out success rate of each epoch, 0..1.
        epsilon: share of policy reuse of each epoch, 0..1.
        kept: epoch of the policy that was kept, from 1.
    """
    width, height = SIZE_IN
    figure = sheet(title, caption, SIZE_IN)
    axes = figure.subplots()
    figure.subplots_adjust(left=0.65 / width, right=1 - 0.2 / width, top=1 - 0.75 / height, bottom=0.85 / height)
    plain(axes)
    epochs = range(1, len(success) + 1)
    axes.plot(epochs, success, color=POLICY_A, linewidth=1.0, label="held-out success")
    axes.plot(epochs, epsilon, color=FAILURE, linewidth=1.2, linestyle="--", label="ε, the share the guide may fly")
    axes.plot([kept], [success[kept - 1]], "o", color=POLICY_A, markersize=6, label=f"policy kept, epoch {kept}")
    axes.set_ylim(-0.03, 1.05)
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0 %", "25 %", "50 %", "75 %", "100 %"])
    axes.set_xlabel("epoch", fontsize=9, color=FAINT)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=3, frameon=False, fontsize=9, labelcolor=INK)
    return paper_sheet.picture(figure, "png")
