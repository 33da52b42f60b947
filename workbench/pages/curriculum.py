"""The Curriculum page: mask subtasks, see what becomes of the task, and launch a stage or the whole chain."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.lattice import Lattice, lattice_figure, mask_text
from layouts.theme import missile_colour
from sim.errors import MaskError
from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask
from workbench.context import AppContext
from workbench.pages.address import go_to, read_query, write_query
from workbench.pages.curriculum_cards import CARD_CSS, observation_card, reward_card, task_card
from workbench.pages.curriculum_launch import LaunchForm
from workbench.pages.curriculum_missiles import MissilePictures
from workbench.pages.fly_settings import read_scenario
from workbench.policies import shipped_success
from workbench.run_folder import shorten
from workbench.runs import Run
from workbench.scenarios import DEFAULT, scenario_choices

PICTURE_HEIGHT = 176
LATTICE_HEIGHT = 430


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Curriculum page of one session."""
    return CurriculumPage(context).layout


class CurriculumPage:
    """The scenario and the mask of one session, and everything that follows them."""

    def __init__(self, context: AppContext) -> None:
        query, scenarios = read_query(), scenario_choices(context.store)
        spec, problems = read_scenario(query, scenarios.values(), DEFAULT)
        self._scenario = load_scenario(spec)
        masked, problem = self._read_mask(query.get("mask", ""))
        self._picker = pmui.Select(
            label="Scenario", options=scenarios, value=spec, size="small", margin=0, width=215, sizing_mode="fixed"
        )
        self._pictures = MissilePictures(
            masked=sorted(masked), colours=self._colours(), height=PICTURE_HEIGHT, sizing_mode="stretch_width", margin=0
        )
        self._lattice = self._make_lattice(masked)
        self._lattice_head = pn.pane.HTML(self._lattice_words(), margin=0, sizing_mode="stretch_width")
        self._drawn = pn.pane.Bokeh(self._lattice.figure, sizing_mode="stretch_width", margin=0)
        self._cards = {name: self._card() for name in ("task", "observation", "reward")}
        self._form = LaunchForm(context.store, query, self._go_live)
        self._alert = pmui.Alert(object="", visible=False, severity="warning", margin=0, sizing_mode="stretch_width")
        self._complain(" ".join([*problems, problem]).strip())
        self._picker.param.watch(self._change_scenario, "value")
        self._pictures.param.watch(self._show, "masked")
        for widget in self._form.widgets.values():
            widget.param.watch(lambda _event: self._write_address(), "value")
        self._show()
        self.layout = self._arrange()

    def _read_mask(self, text: str) -> tuple[frozenset[int], str]:
        try:
            return parse_mask(text, self._scenario.launch.missiles), ""
        except MaskError as error:
            return frozenset(), f"{shorten(str(error), 160)}. None is masked."

    def _colours(self) -> list[str]:
        return [missile_colour(number) for number in range(1, self._scenario.launch.missiles + 1)]

    def _make_lattice(self, masked: frozenset[int]) -> Lattice:
        missiles = self._scenario.launch.missiles
        learned = shipped_success(self._scenario)
        success = {frozenset(range(n + 1, missiles + 1)): rate for n, rate in learned.items()}
        lattice = lattice_figure(missiles, masked, success, LATTICE_HEIGHT)
        # The panel's colour shows through.
        lattice.figure.background_fill_alpha = lattice.figure.border_fill_alpha = 0.0
        lattice.nodes.selected.on_change("indices", self._tap)
        return lattice

    def _lattice_words(self) -> str:
        rates = "; %: success of the shipped policy in fresh engagements" if shipped_success(self._scenario) else ""
        return _heading("Lattice of tasks", f"click a task; blue is Algorithm 3's chain{rates}")

    def _change_scenario(self, event: Any) -> None:
        self._scenario = load_scenario(event.new)
        missiles = self._scenario.launch.missiles
        masked = [number for number in self._pictures.masked if number <= missiles]
        self._lattice = self._make_lattice(frozenset(masked))
        self._drawn.object, self._lattice_head.object = self._lattice.figure, self._lattice_words()
        self._complain("")
        self._pictures.param.update(colours=self._colours(), masked=masked)
        self._show()

    def _card(self) -> pn.pane.HTML:
        return pn.pane.HTML("", stylesheets=[CARD_CSS], sizing_mode="stretch_width", margin=0)

    def _arrange(self) -> pn.viewable.Viewable:
        head = pmui.Row(self._cards["task"], self._picker, margin=0, sx={"gap": "12px", "alignItems": "center"})
        subtasks = _panel("1 · Mask subtasks", head, self._pictures)
        lattice = _panel("", self._lattice_head, self._drawn)
        launch = _panel("2 · Train", self._form.layout)
        left = _column("1 1 640px", subtasks, lattice)
        right = _column("1 1 420px", launch, _panel("", self._cards["observation"]), _panel("", self._cards["reward"]))
        return pn.Column(
            self._alert,
            pn.FlexBox(left, right, gap="14px", align_items="stretch", sizing_mode="stretch_width", margin=0),
            sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "10px"},
        )  # fmt: skip

    def _show(self, _event: object = None) -> None:
        task = Task(self._scenario, frozenset(self._pictures.masked))
        self._cards["task"].object = task_card(task)
        self._cards["observation"].object = observation_card(task)
        self._cards["reward"].object = reward_card(task)
        self._lattice.select(task.masked)
        self._form.show(task, self._picker.value)
        self._write_address()

    def _tap(self, _attribute: str, _old: object, indices: list[int]) -> None:
        if indices:
            nodes = self._lattice.nodes
            mask = str(nodes.data["mask"][indices[0]])
            self._pictures.masked = sorted(parse_mask(mask, self._scenario.launch.missiles))
            # Cleared, so that the same node can be tapped again.
            nodes.selected.indices = []

    def _write_address(self) -> None:
        scenario = "" if self._picker.value == DEFAULT else self._picker.value
        mask = mask_text(self._pictures.masked)
        write_query(scenario=scenario, mask=mask, **self._form.to_query())

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)

    def _go_live(self, runs: list[Run]) -> None:
        go_to("/live", run=runs[0].id)


def _column(flex: str, *parts: Any) -> pmui.Column:
    return pmui.Column(*parts, margin=0, styles={"flex": flex, "min-width": "0"}, sx={"gap": "14px"})


def _heading(title: str, note: str = "") -> str:
    hint = f'<span style="opacity:.65;font-size:12.5px;margin-left:10px">{note}</span>' if note else ""
    return f'<span style="font-size:15px;font-weight:650">{title}</span>{hint}'


def _panel(title: str, *parts: Any) -> pmui.Paper:
    head = [pn.pane.HTML(_heading(title), margin=0, sizing_mode="stretch_width")] if title else []
    return pmui.Paper(
        *head, *parts, elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px", "gap": "12px"}
    )
