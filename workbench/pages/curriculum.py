"""The Curriculum page: mask subtasks, see what becomes of the task, and launch a stage or the whole chain."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.lattice import lattice_figure, mask_text
from layouts.theme import NEUTRAL, POLICY_A, SUCCESS, missile_colour
from sim.errors import MaskError
from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask
from workbench.context import AppContext
from workbench.pages.address import go_to, read_query, write_query
from workbench.pages.curriculum_cards import CARD_CSS, observation_card, reward_card, task_card
from workbench.pages.curriculum_launch import LaunchForm
from workbench.pages.curriculum_missiles import MissilePictures
from workbench.policies import shipped_success
from workbench.run_folder import shorten
from workbench.runs import Run

SCENARIO = "default"
PICTURE_HEIGHT = 176
LATTICE_HEIGHT = 430


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Curriculum page of one session."""
    return CurriculumPage(context).layout


class CurriculumPage:
    """The mask of one session, and everything that follows it."""

    def __init__(self, context: AppContext) -> None:
        self._scenario = load_scenario(SCENARIO)
        query = read_query()
        masked, problem = self._read_mask(query.get("mask", ""))
        missiles = self._scenario.launch.missiles
        colours = [missile_colour(number) for number in range(1, missiles + 1)]
        self._pictures = MissilePictures(
            masked=sorted(masked), colours=colours, height=PICTURE_HEIGHT, sizing_mode="stretch_width", margin=0
        )
        success = {frozenset(range(n + 1, missiles + 1)): rate for n, rate in shipped_success().items()}
        self._lattice, self._nodes = lattice_figure(missiles, selected=masked, success=success, height=LATTICE_HEIGHT)
        self._lattice.background_fill_alpha = self._lattice.border_fill_alpha = 0.0  # the panel's colour shows through
        self._cards = {name: self._card() for name in ("task", "observation", "reward")}
        self._form = LaunchForm(context.store, query, self._go_live)
        self._alert = pmui.Alert(
            object=html.escape(problem),
            visible=bool(problem),
            severity="warning",
            margin=0,
            sizing_mode="stretch_width",
        )
        self._pictures.param.watch(self._show, "masked")
        self._nodes.selected.on_change("indices", self._tap)
        for widget in self._form.widgets.values():
            widget.param.watch(lambda _event: self._write_address(), "value")
        self._show()
        self.layout = self._arrange()

    def _read_mask(self, text: str) -> tuple[frozenset[int], str]:
        try:
            return parse_mask(text, self._scenario.launch.missiles), ""
        except MaskError as error:
            return frozenset(), f"{shorten(str(error), 160)}. None is masked."

    def _card(self) -> pn.pane.HTML:
        return pn.pane.HTML("", stylesheets=[CARD_CSS], sizing_mode="stretch_width", margin=0)

    def _arrange(self) -> pn.viewable.Viewable:
        subtasks = _panel("1 · Mask subtasks", self._cards["task"], self._pictures)
        lattice = _panel(
            "Lattice of tasks",
            pn.pane.Bokeh(self._lattice, sizing_mode="stretch_width", margin=0),
            note="click a task; blue is Algorithm 3's chain; %: held-out success that promoted the shipped policy",
        )
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
        self._ring(mask_text(task.masked))
        self._form.show(task)
        self._write_address()

    def _ring(self, mask: str) -> None:
        """Mark the chosen task in the lattice."""
        masks, fills = self._nodes.data["mask"], self._nodes.data["fill"]
        for row, (each, fill) in enumerate(zip(masks, fills, strict=True)):
            idle = POLICY_A if fill == POLICY_A else NEUTRAL
            ring, width = (SUCCESS, 5.0) if each == mask else (idle, 1.5)
            self._nodes.patch({"ring": [(row, ring)], "ring_width": [(row, width)]})

    def _tap(self, _attribute: str, _old: object, indices: list[int]) -> None:
        if indices:
            mask = str(self._nodes.data["mask"][indices[0]])
            self._pictures.masked = sorted(parse_mask(mask, self._scenario.launch.missiles))
            # Cleared, so that the same node can be tapped again.
            self._nodes.selected.indices = []

    def _write_address(self) -> None:
        write_query(mask=mask_text(frozenset(self._pictures.masked)), **self._form.to_query())

    def _go_live(self, runs: list[Run]) -> None:
        go_to("/live", run=runs[0].id)


def _column(flex: str, *parts: Any) -> pmui.Column:
    return pmui.Column(*parts, margin=0, styles={"flex": flex, "min-width": "0"}, sx={"gap": "14px"})


def _panel(title: str, *parts: Any, note: str = "") -> pmui.Paper:
    head = []
    if title:
        hint = f'<span style="opacity:.65;font-size:12.5px;margin-left:10px">{note}</span>' if note else ""
        words = f'<span style="font-size:15px;font-weight:650">{title}</span>{hint}'
        head = [pn.pane.HTML(words, margin=0, sizing_mode="stretch_width")]
    return pmui.Paper(
        *head, *parts, elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px", "gap": "12px"}
    )
