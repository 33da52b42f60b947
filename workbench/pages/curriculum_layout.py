"""Where the parts of the Curriculum page stand, and its headings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui

from sim.scenario import Scenario
from sim.task import Task
from workbench.pages.curriculum_fields import VARIANT_HELP
from workbench.pages.wrapping import wrapping
from workbench.policies import shipped_success


def arrange(
    alert: Any, picker: Any, pictures: Any, cards: Mapping[str, Any], lattice_head: Any, lattice: Any, chain: Any,
    form: Any, under_way: Any,
) -> pn.viewable.Viewable:  # fmt: skip
    """Task and curriculum side by side, training below; in a narrow window one under the other."""
    head = pmui.Row(cards["task"], picker, margin=0, sx={"gap": "12px", "alignItems": "center"})
    task = _panel(
        heading("1 · Mask subtasks", "a missile is a subtask; click one to mask it and make the task easier"),
        head, pictures, cards["observation"], cards["reward"], classes="tour-task",
    )  # fmt: skip
    curriculum = _panel(lattice_head, lattice, chain, classes="tour-chain")
    launch = _panel(heading("3 · Train", VARIANT_HELP), form, classes="tour-train")
    runs = pmui.Paper(
        under_way,
        elevation=1,
        margin=0,
        sizing_mode="stretch_width",
        sx={"p": "12px 16px"},
        styles={"flex": "0 0 auto"},
        visible=under_way.visible,
    )
    under_way.param.watch(lambda event: setattr(runs, "visible", event.new), "visible")
    left, right = _column("1 1 560px", task), _column("1 1 560px", curriculum)
    return pn.Column(
        alert,
        wrapping(left, right, gap="14px", align="stretch"),
        launch, runs, sizing_mode="stretch_width", margin=(12, 18), styles={"gap": "14px"},
    )  # fmt: skip


def heading(title: str, note: str = "") -> str:
    """A title and, smaller, what to do there, as HTML."""
    hint = f'<span style="opacity:.75;font-size:12.5px;margin-left:10px">{note}</span>' if note else ""
    return f'<span style="font-size:15px;font-weight:650">{title}</span>{hint}'


def lattice_words(scenario: Scenario) -> str:
    """What the lattice shows."""
    rates = ", %: success of the shipped policy" if shipped_success(scenario) else ""
    return heading("2 · Curriculum", f"all tasks, click one; blue: what will be trained{rates}")


def note_of(task: Task, met: Sequence[int], chain: bool, from_scratch: bool) -> str:
    """What the order of the stages means."""
    if not task.missiles:
        return "Nothing to learn: the navigation expert solves the task without missiles."
    if from_scratch:
        return "One stage: who learns from scratch has no guide, and hands nothing on."
    if not chain:
        return (
            "One stage: the guide knows fewer missiles, and helps wherever the others show the default (Algorithm 4)."
        )
    listed = ", ".join(map(str, met[::-1]))
    return (
        f"Algorithm 3 with τ = {listed}: the most complex subtask first, which is masked first and met last. "
        "Drag a stage, or press arrow keys on it, to change the order."
    )


def _column(flex: str, *parts: Any) -> pmui.Column:
    return pmui.Column(*parts, margin=0, styles={"flex": flex, "min-width": "0"}, sx={"gap": "14px"})


def _panel(head: Any, *parts: Any, classes: str) -> pmui.Paper:
    if isinstance(head, str):
        head = pn.pane.HTML(head, margin=0, sizing_mode="stretch_width")
    return pmui.Paper(
        head, *parts, elevation=1, margin=0, sizing_mode="stretch_width", css_classes=[classes],
        styles={"flex": "0 0 auto"}, sx={"p": "12px 16px", "gap": "10px"},
    )  # fmt: skip
