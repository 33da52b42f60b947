"""What stands below the table of runs: curves, difference, the panel of one run, and the dialogs.

Made once the table stands in the browser: two figures and thirty widgets take ten times as long as bar and table.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.run_difference import DIFFERENCE_CSS
from workbench.pages.runs_actions import RunsActions
from workbench.pages.runs_curves import RunsCurves
from workbench.pages.runs_detail import RunsDetail
from workbench.pages.runs_layout import beside, difference_title, panel
from workbench.pages.runs_settings import RunsSettings
from workbench.pages.runs_view import RunsList, RunsMore
from workbench.run_notes import RunNotes


class RunsBelow:
    """Everything about what is ticked and about the run that is read about."""

    def __init__(
        self,
        settings: RunsSettings,
        actions: RunsActions,
        change: Callable[..., None],
        act: Callable[[str], None],
        write: Callable[[RunNotes], None],
    ) -> None:
        self.actions = actions
        self.curves = RunsCurves(settings, change)
        self.detail = RunsDetail(act, write)
        self.difference = pn.pane.HTML("", stylesheets=[DIFFERENCE_CSS], sizing_mode="stretch_width", margin=0)
        self.every = pmui.Checkbox(label="all fields", value=settings.every_field, margin=0, size="small")
        self.every.param.watch(lambda event: change(every_field=event.new), "value")
        self._difference = panel(difference_title(self.every), self.difference)
        self._difference.visible = False
        left = (panel(self.curves.layout), self._difference)
        self.items: list[Any] = [beside(left, panel(self.detail.layout)), *actions.dialogs]

    def take(self, settings: RunsSettings, listed: RunsList | None) -> None:
        """Show the view's settings and the run it reads about."""
        self.curves.take(settings)
        self.every.value = settings.every_field
        if listed is not None:
            self.detail.pin.label = "Unpin" if settings.baseline == settings.run else "Pin as baseline"
            self.detail.show(listed.record, listed.run, listed.missing)

    def show(self, settings: RunsSettings, more: RunsMore) -> None:
        """Show what took longer."""
        self.curves.show(settings, more.drawing)
        self.detail.show_lineage(more.lineage)
        self.difference.object = more.difference
        self._difference.visible = bool(more.difference)
