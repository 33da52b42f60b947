"""The Live page: a run as it learns, or as it learned: progress, stages, curves, events, and the Stop button."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from agents.config import TrainingConfig
from sim.errors import SubMasError
from sim.scenario_file import load_scenario
from sim.task import Task
from workbench.context import AppContext
from workbench.pages.address import fly_address, read_query, write_query
from workbench.pages.live_cards import LIVE_CSS, event_list, head, number_cards, stage_cards
from workbench.pages.live_curves import LiveCurves
from workbench.pages.live_watch import RunWatch
from workbench.policies import title
from workbench.run_state import RunState
from workbench.runs import Run
from workbench.scenarios import other_scenario
from workbench.stages import summarise

TICK_MS = 500
LIST_EVERY = 6
"""Ticks between two looks for new runs."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Live page of one session."""
    return LivePage(context).layout


class LivePage:
    """The run that one session looks at."""

    def __init__(self, context: AppContext) -> None:
        self._store = context.store
        self._watch: RunWatch | None = None
        self._ticks = 0
        self._make_controls()
        self._make_views()
        self.layout = self._arrange()
        self._list_runs()
        self._open_first(read_query().get("run", ""))
        self._picker.param.watch(self._pick, "value")
        callback = pn.state.add_periodic_callback(self._tick, TICK_MS)
        pn.state.on_session_destroyed(lambda _session: callback.stop())

    def _make_controls(self) -> None:
        self._picker = pmui.Select(label="Run", options={}, size="small", sizing_mode="stretch_width", margin=0)
        self._fly = pmui.Button(
            label="Fly latest policy", icon="flight_takeoff", variant="outlined", width=190, margin=0
        )
        self._stop = pmui.Button(
            label="Stop", icon="stop_circle", color="error", variant="outlined", width=130, margin=0
        )
        self._stop.on_click(self._ask)
        yes = pmui.Button(label="Stop this run", color="error", margin=0)
        no = pmui.Button(label="Let it learn on", variant="text", margin=0)
        yes.on_click(self._confirmed)
        no.on_click(self._close)
        words = "It stops at the end of its epoch and keeps its best policy. It cannot be continued."
        self._dialog = pmui.Dialog(words, pmui.Row(yes, no, margin=(16, 0, 0, 0)), title="Stop this run?", open=False)

    def _make_views(self) -> None:
        self._html = {name: self._pane() for name in ("head", "stages", "numbers")}
        self._events = pn.pane.HTML("", stylesheets=[LIVE_CSS], sizing_mode="stretch_width", height=500, margin=0)
        self._progress = pmui.LinearProgress(value=0, sizing_mode="stretch_width", margin=0, height=8)
        self._alert = pmui.Alert(object="", visible=False, severity="warning", margin=0, sizing_mode="stretch_width")
        self._curves = LiveCurves()
        self._waiting = pn.pane.HTML(
            "The curves begin with the first finished epoch.", stylesheets=[LIVE_CSS], margin=0
        )

    def _pane(self, text: str = "") -> pn.pane.HTML:
        return pn.pane.HTML(text, stylesheets=[LIVE_CSS], sizing_mode="stretch_width", margin=0)

    def _arrange(self) -> pn.viewable.Viewable:
        curves = _column("4 1 860px", _panel(self._waiting, self._curves.layout))
        events = _column("1 1 300px", _panel(self._events))
        self._run_views = pn.Column(
            _panel(self._html["head"], self._progress, self._html["stages"], self._html["numbers"]),
            pn.FlexBox(curves, events, gap="12px", sizing_mode="stretch_width", margin=0),
            sizing_mode="stretch_width", margin=0, styles={"gap": "12px"},
        )  # fmt: skip
        controls = pmui.Row(self._picker, self._fly, self._stop, margin=0, sx={"gap": "12px", "alignItems": "center"})
        return pn.Column(
            controls, self._alert, self._run_views, self._dialog,
            sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "12px"},
        )  # fmt: skip

    def _open_first(self, wanted: str) -> None:
        """The run the address names, else the newest."""
        runs = [run for run in self._store.list() if not run.problem]
        if wanted:
            try:
                self._open(self._store.get(wanted))
                return
            except SubMasError as error:
                self._complain(f"{error}.")
        if not runs:
            self._run_views.visible = self._stop.visible = self._fly.visible = False
            self._complain(self._alert.object or "No run yet. The Curriculum page launches one.")
            return
        self._open(next((run for run in runs if run.state.active), runs[0]))

    def _open(self, run: Run) -> None:
        if run.problem:
            self._run_views.visible = False
            self._complain(f"Run {run.id} cannot be shown: {run.problem}.")
            return
        self._watch = RunWatch(run)
        self._run_views.visible = True
        if self._picker.value != run.id:
            self._picker.value = run.id
        write_query(run=run.id)
        self._tick()

    def _pick(self, event: Any) -> None:
        if event.new and (self._watch is None or event.new != self._watch.run.id):
            self._complain("")
            self._open(self._store.get(event.new))

    def _list_runs(self) -> None:
        runs = [run for run in self._store.list() if not run.problem]
        options = {f"{title(run.config)} · {run.state.state} · {run.id}": run.id for run in runs}
        if options != self._picker.options:
            # A run's label changes with its state; the choice stays.
            chosen = (
                self._picker.value if self._picker.value in options.values() else next(iter(options.values()), None)
            )
            self._picker.param.update(options=options, value=chosen)

    def _tick(self) -> None:
        self._ticks += 1
        if self._ticks % LIST_EVERY == 0:
            self._list_runs()
        if self._watch is not None and self._watch.look():
            self._show(self._watch)

    def _show(self, watch: RunWatch) -> None:
        try:
            state, config = watch.run.state, watch.run.config
            tasks = stage_tasks(config)
        except SubMasError as error:
            self._complain(f"Run {watch.run.id} cannot be shown any more: {error}.")
            return
        row = watch.rows[-1] if watch.rows else None
        self._html["head"].object = head(state, row, other_scenario(config.scenario))
        self._html["stages"].object = stage_cards(tasks, summarise(watch.rows), state, row)
        self._html["numbers"].object = number_cards(row)
        self._events.object = event_list(watch.events)
        self._progress.value = round(100 * state.progress)
        self._curves.show(watch.rows)
        self._curves.layout.visible = bool(watch.rows)
        self._waiting.visible = not watch.rows
        self._update_buttons(watch.run, state)
        if watch.problem:
            self._complain(f"Not all of this run can be shown: {watch.problem}.")

    def _update_buttons(self, run: Run, state: RunState) -> None:
        # Never disabled: the browser now and then missed that it was enabled again. Without a policy Fly says so.
        self._fly.href = fly_address(run)
        asked = state.state == "running" and run.stop_requested()
        self._stop.disabled = asked or not state.active
        self._stop.label = "Stopping …" if asked else "Stop"

    def _ask(self, _event: object) -> None:
        self._dialog.open = True

    def _close(self, _event: object) -> None:
        self._dialog.open = False

    def _confirmed(self, _event: object) -> None:
        self._dialog.open = False
        if self._watch is not None:
            self._watch.run.request_stop()
            self._show(self._watch)

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)


def stage_tasks(config: TrainingConfig) -> list[str]:
    """Names of the tasks a training learns, in order.

    Raises:
        ScenarioError: the scenario of the run is not there any more.
    """
    target = Task(load_scenario(config.scenario))
    return [target.mask(missile for missile in target.missiles if missile not in kept).name for kept in config.stages]


def _column(flex: str, panel: pmui.Paper) -> pmui.Column:
    return pmui.Column(panel, margin=0, styles={"flex": flex, "min-width": "0"})


def _panel(*parts: Any) -> pmui.Paper:
    return pmui.Paper(*parts, elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px", "gap": "12px"})
