"""Downloads of the Compare page: tables as CSV, the bars as a picture."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from typing import Literal

import panel_material_ui as pmui

from workbench.comparison.closely import Closely
from workbench.comparison.grid import Grid
from workbench.comparison.tables import engagements_table, figures_table, pairs_table
from workbench.pages.compare_bars import bars_of
from workbench.pages.compare_settings import CompareSettings


class CompareDownloads:
    """Buttons; what they save is made when one is clicked."""

    def __init__(self) -> None:
        self._shown: tuple[Grid, Closely | None, CompareSettings, Mapping[str, str], Mapping[str, str]] | None = None
        makers: dict[str, tuple[str, str, Callable[[], bytes]]] = {
            "Figures": (
                "comparison.csv",
                "Figures: success, return and causes of every policy on every task",
                self._figures,
            ),
            "Pairs": ("pairs.csv", "Pairs: the paired table", self._pairs),
            "Engagements": ("engagements.csv", "Engagements: each of the two policies on this task", self._engagements),
            "PNG": ("comparison.png", "PNG: the bars as a picture", lambda: self._picture("png")),
            "SVG": ("comparison.svg", "SVG: the bars as a drawing", lambda: self._picture("svg")),
        }
        buttons = [
            pmui.FileDownload(
                callback=lambda make=make: io.BytesIO(make()), filename=filename, label=label, description=words,
                variant="text", size="small", margin=0, sizing_mode=None, auto=True, embed=False,
            )
            for label, (filename, words, make) in makers.items()
        ]  # fmt: skip
        self.layout = pmui.Row(*buttons, margin=0, width=470, sizing_mode="fixed")

    def offer(
        self, grid: Grid, close: Closely | None, settings: CompareSettings, labels: Mapping[str, str],
        inks: Mapping[str, str],
    ) -> None:  # fmt: skip
        """What is on the page now."""
        self._shown = (grid, close, settings, labels, inks)

    def _figures(self) -> bytes:
        return figures_table(self._shown[0]).encode() if self._shown else b""

    def _pairs(self) -> bytes:
        _, close, settings, *_ = self._shown or (None, None, None)
        if close is None or settings is None:
            return b""
        return pairs_table(settings.policy, settings.against, close.pairs).encode()

    def _engagements(self) -> bytes:
        if self._shown is None or not self._shown[2].task:
            return b""
        grid, _, settings, _, _ = self._shown
        cells = [grid.cell(policy, settings.task) for policy in dict.fromkeys((settings.policy, settings.against))]
        return engagements_table([cell.evaluation for cell in cells if cell.evaluation is not None]).encode()

    def _picture(self, kind: Literal["png", "svg"]) -> bytes:
        from layouts.comparison_picture import comparison_picture
        from layouts.paper_sheet import picture

        if self._shown is None:
            return b""
        grid, _, settings, labels, inks = self._shown
        success, returns = bars_of(grid, labels, inks)
        caption = f"scenario {grid.scenario}, {grid.episodes} engagements each, seed {grid.seed}; 95 % intervals"
        return picture(comparison_picture(settings.tasks, success, returns, caption), kind)
