"""The Runs page: every run in a table, to search, to open, to fly, to delete."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from sim.errors import SubMasError
from workbench.context import AppContext
from workbench.pages.address import fly_address, read_query, write_query
from workbench.pages.runs_table import COLUMNS, describe, runs_frame, runs_table
from workbench.runs import Run

TICK_MS = 1000
TABLE_HEIGHT = 520
DETAIL_CSS = """
:host { color: var(--panel-on-background-color); font: 14px/1.45 var(--bokeh-base-font, sans-serif) }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 3px 16px; margin: 0 }
dt { opacity: .65 } dd { margin: 0; overflow-wrap: anywhere }
"""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Runs page of one session."""
    return RunsPage(context).layout


class RunsPage:
    """The table of one session and the run chosen in it."""

    def __init__(self, context: AppContext) -> None:
        self._store = context.store
        self._runs = self._store.list()
        self._seen = self._signatures()
        self._chosen: Run | None = None
        self._table = runs_table(runs_frame(self._runs), TABLE_HEIGHT)
        self._table.param.watch(self._select, "selection")
        self._make_controls()
        self.layout = self._arrange()
        self._choose(read_query().get("run", ""))
        callback = pn.state.add_periodic_callback(self._tick, TICK_MS)
        pn.state.on_session_destroyed(lambda _session: callback.stop())

    def _make_controls(self) -> None:
        self._open = pmui.Button(label="Open in Live", icon="show_chart", color="primary", width=160, margin=0)
        self._fly = pmui.Button(label="Fly", icon="flight_takeoff", variant="outlined", width=100, margin=0)
        self._delete = pmui.Button(
            label="Delete", icon="delete", color="error", variant="outlined", width=120, margin=0
        )
        self._delete.on_click(self._ask)
        self._detail = pn.pane.HTML("", stylesheets=[DETAIL_CSS], sizing_mode="stretch_width", margin=0)
        self._count = pn.pane.HTML("", stylesheets=[DETAIL_CSS], sizing_mode="stretch_width", margin=0)
        self._alert = pmui.Alert(object="", visible=False, severity="warning", margin=0, sizing_mode="stretch_width")
        yes = pmui.Button(label="Move to the trash", color="error", margin=0)
        no = pmui.Button(label="Keep it", variant="text", margin=0)
        yes.on_click(self._confirmed)
        no.on_click(self._close)
        self._question = pn.pane.HTML("", stylesheets=[DETAIL_CSS], margin=0)
        buttons = pmui.Row(yes, no, margin=(16, 0, 0, 0))
        self._dialog = pmui.Dialog(self._question, buttons, title="Delete this run?", open=False)

    def _arrange(self) -> pn.viewable.Viewable:
        buttons = pmui.Row(self._open, self._fly, self._delete, margin=0, sx={"gap": "12px"}, width=410)
        self._actions = pmui.Paper(
            pn.FlexBox(buttons, self._detail, gap="24px", sizing_mode="stretch_width", margin=0),
            elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px"},
        )  # fmt: skip
        return pn.Column(
            self._alert, self._count, self._table, self._actions, self._dialog,
            sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "12px"},
        )  # fmt: skip

    def _choose(self, wanted: str) -> None:
        """Select the run the address names."""
        self._show()
        if not wanted:
            return
        ids = [run.id for run in self._runs]
        if wanted in ids:
            # Once the table stands in the browser: it forgets a selection it is born with.
            pn.state.onload(lambda: self._table.param.update(selection=[ids.index(wanted)]))
            return
        try:
            self._store.get(wanted)
        except SubMasError as error:
            self._complain(f"{error}.")

    def _select(self, _event: object) -> None:
        rows = self._table.selection
        run_id = str(self._table.value["run"].iloc[rows[0]]) if rows else ""
        self._chosen = next((run for run in self._runs if run.id == run_id), None)
        write_query(run=run_id)
        self._show()

    def _signatures(self) -> list[Any]:
        return [(run.id, run.problem, run.signature()) for run in self._runs]

    def _tick(self) -> None:
        self._runs = self._store.list()
        seen = self._signatures()
        if seen != self._seen:
            self._seen = seen
            self._refresh()

    def _refresh(self) -> None:
        """Patch the cells that changed; a new table only when runs came or went, as it forgets its place."""
        frame, old = runs_frame(self._runs), self._table.value
        if list(frame["run"]) != list(old["run"]):
            chosen = self._chosen.id if self._chosen else ""
            self._table.value = frame
            ids = list(frame["run"])
            self._table.selection = [ids.index(chosen)] if chosen in ids else []
        else:
            self._patch(frame, old)
        self._show()

    def _patch(self, frame: Any, old: Any) -> None:
        changes: dict[str, list[tuple[int, Any]]] = {}
        for column in COLUMNS:
            for row, (new, before) in enumerate(zip(frame[column], old[column], strict=True)):
                if new != before and not (new != new and before != before):
                    changes.setdefault(column, []).append((row, new))
        if changes:
            self._table.patch(changes)

    def _show(self) -> None:
        run = self._chosen
        number = len(self._runs)
        self._count.object = (
            f"{number} run{'s' * (number != 1)} in {html.escape(str(self._store.root))}"
            if number
            else "No run yet. The Curriculum page launches one."
        )
        self._actions.visible = run is not None
        if run is None:
            return
        pairs = "".join(f"<dt>{name}</dt><dd>{html.escape(text)}</dd>" for name, text in describe(run))
        self._detail.object = f"<dl>{pairs}</dl>"
        good = not run.problem
        self._open.param.update(href=f"/live?run={run.id}", disabled=not good)
        flyable = good and run.policy_path() is not None
        self._fly.param.update(href=fly_address(run) if flyable else "/fly", disabled=not flyable)
        self._delete.disabled = good and run.state.state == "running"

    def _ask(self, _event: object) -> None:
        if self._chosen is not None:
            name = self._chosen.id if self._chosen.problem else self._chosen.config.name or self._chosen.id
            self._question.object = f"{html.escape(name)} is moved to the folder .trash of the runs."
            self._dialog.open = True

    def _close(self, _event: object) -> None:
        self._dialog.open = False

    def _confirmed(self, _event: object) -> None:
        self._dialog.open = False
        if self._chosen is None:
            return
        run_id, self._chosen = self._chosen.id, None
        self._store.delete(run_id)
        self._tick()

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)
