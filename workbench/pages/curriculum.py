"""The Curriculum page: mask subtasks, see what becomes of the task, order the chain, and launch trainings."""

from __future__ import annotations

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.lattice import Lattice, Mask, chain_of, lattice_figure, mask_text
from layouts.lattice_places import ROOMY_UP_TO
from layouts.theme import missile_colour
from sim.errors import MaskError, shorten
from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask
from workbench.context import AppContext
from workbench.pages.address import go_to, read_query, write_query
from workbench.pages.curriculum_cards import CARD_CSS, observation_card, reward_card, task_card
from workbench.pages.curriculum_chain import StageChain, merged, read_order, single_card, stage_cards
from workbench.pages.curriculum_launch import LaunchForm
from workbench.pages.curriculum_layout import arrange, lattice_words, note_of
from workbench.pages.curriculum_missiles import MissilePictures
from workbench.pages.curriculum_runs import LaunchedRuns
from workbench.pages.curriculum_set import listed
from workbench.pages.fly_settings import read_scenario
from workbench.policies import EXPERTS, SHIPPED_LABELS, shipped_success
from workbench.runs import Run
from workbench.scenarios import DEFAULT, scenario_choices

PICTURE_HEIGHT = 132
LATTICE_HEIGHT, TALL_HEIGHT = 300, 430
"""Of a lattice with room for every task's missiles, and of one without [px]."""


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Curriculum page of one session."""
    return CurriculumPage(context).layout


class CurriculumPage:
    """The scenario, the mask and the order of one session, and everything that follows them."""

    def __init__(self, context: AppContext) -> None:
        query, scenarios = read_query(), scenario_choices(context.store)
        spec, problems = read_scenario(query, scenarios.values(), DEFAULT)
        self._scenario = load_scenario(spec)
        masked, problem = self._read_mask(query.get("mask", ""))
        self._met, disorder = read_order(query.get("order", ""), self._scenario.launch.missiles)
        self._picker = pmui.Select(
            label="Scenario", options=scenarios, value=spec, size="small", margin=0, width=215, sizing_mode="fixed"
        )
        self._pictures = MissilePictures(
            masked=sorted(masked), colours=self._colours(), height=PICTURE_HEIGHT, sizing_mode="stretch_width", margin=0
        )
        self._lattice = self._make_lattice(masked)
        self._lattice_head = pn.pane.HTML(lattice_words(self._scenario), margin=0, sizing_mode="stretch_width")
        self._drawn = pn.pane.Bokeh(self._lattice.figure, sizing_mode="stretch_width", margin=0)
        self._chain = StageChain(sizing_mode="stretch_width", margin=0)
        self._cards = {name: self._card() for name in ("task", "observation", "reward")}
        self._form = LaunchForm(context.store, query, self._go_on)
        self._under_way = LaunchedRuns(context.store)
        self._alert = pmui.Alert(object="", visible=False, severity="warning", margin=0, sizing_mode="stretch_width")
        self._complain(" ".join([*problems, problem, disorder]).strip())
        self._watch()
        self._show()
        self.layout = arrange(
            self._alert, self._picker, self._pictures, self._cards, self._lattice_head, self._drawn, self._chain,
            self._form.layout, self._under_way.pane,
        )  # fmt: skip

    def _watch(self) -> None:
        self._picker.param.watch(self._change_scenario, "value")
        self._pictures.param.watch(self._show, "masked")
        self._chain.param.watch(self._reorder, "met")
        for widget in self._form.widgets.values():
            widget.param.watch(lambda _event: self._show_chain(), "value")

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
        lattice = lattice_figure(missiles, masked, success, LATTICE_HEIGHT if missiles <= ROOMY_UP_TO else TALL_HEIGHT)
        # The panel's colour shows through.
        lattice.figure.background_fill_alpha = lattice.figure.border_fill_alpha = 0.0
        lattice.nodes.selected.on_change("indices", self._tap)
        return lattice

    def _change_scenario(self, event: Any) -> None:
        self._scenario = load_scenario(event.new)
        missiles = self._scenario.launch.missiles
        masked = [number for number in self._pictures.masked if number <= missiles]
        self._met = list(range(1, missiles + 1))
        self._lattice = self._make_lattice(frozenset(masked))
        self._drawn.object, self._lattice_head.object = self._lattice.figure, lattice_words(self._scenario)
        self._complain("")
        self._pictures.param.update(colours=self._colours(), masked=masked)
        self._show()

    def _card(self) -> pn.pane.HTML:
        return pn.pane.HTML("", stylesheets=[CARD_CSS], sizing_mode="stretch_width", margin=0)

    @property
    def _task(self) -> Task:
        return Task(self._scenario, frozenset(self._pictures.masked))

    @property
    def _met_here(self) -> list[int]:
        """Missiles of the chosen task in the order they are met."""
        return [missile for missile in self._met if missile not in self._pictures.masked]

    def _show(self, _event: object = None) -> None:
        task = self._task
        self._cards["task"].object = task_card(task)
        self._cards["observation"].object = observation_card(task)
        self._cards["reward"].object = reward_card(task)
        self._form.show(task, self._picker.value, self._met_here)
        self._show_chain()

    def _show_chain(self) -> None:
        """The stages, and what else depends on whether there is one of them or a chain."""
        task, met, chain, scratch = self._task, self._met_here, self._form.chain, self._form.from_scratch
        guide = "none, it learns from scratch" if scratch else _words_of(self._form.first_guide)
        self._lattice.select(task.masked, self._trained(task, met))
        self._chain.param.update(
            stages=stage_cards(task, met, guide) if chain else single_card(task, guide),
            met=met, movable=chain and len(met) > 1, note=note_of(task, met, chain, scratch), usual=met == sorted(met),
        )  # fmt: skip
        self._write_address()

    def _trained(self, task: Task, met: list[int]) -> list[Mask]:
        return chain_of(self._scenario.launch.missiles, met) if self._form.chain else [task.masked]

    def _reorder(self, event: Any) -> None:
        """The browser has moved a stage."""
        if event.new != self._met_here and sorted(event.new) == sorted(self._met_here):
            self._met = merged(self._met, event.new)
            self._show()

    def _tap(self, _attribute: str, _old: object, indices: list[int]) -> None:
        if indices:
            nodes = self._lattice.nodes
            mask = str(nodes.data["mask"][indices[0]])
            self._pictures.masked = sorted(parse_mask(mask, self._scenario.launch.missiles))
            # Cleared, so that the same node can be tapped again.
            nodes.selected.indices = []

    def _write_address(self) -> None:
        scenario = "" if self._picker.value == DEFAULT else self._picker.value
        order = "" if self._met == sorted(self._met) else listed(self._met[::-1])
        mask = mask_text(self._pictures.masked)
        write_query(scenario=scenario, mask=mask, order=order, **self._form.to_query())

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence)
        self._alert.visible = bool(sentence)

    def _go_on(self, runs: list[Run]) -> None:
        """One run is watched on its own page, several from here."""
        self._under_way.add(runs)
        if len(runs) == 1:
            go_to("/live", run=runs[0].id)


def _words_of(guide: str) -> str:
    """A guide for a person: what the lists call it, a run by its id."""
    if not guide:
        return "none yet"
    return EXPERTS.get(guide) or SHIPPED_LABELS.get(guide, f"run {guide}")
