"""Algorithm 3's chain as a row of stages that can be put into another order, by hand or by keyboard."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.theme import missile_colour
from sim.task import Task
from workbench.pages.curriculum_cards import title


class StageChain(JSComponent):
    """Stages in the order they are trained; dragging one changes when its missile is met."""

    stages = param.List(default=[], doc="dicts of missile, title, guide, known and colours, the first stage first")
    met = param.List(default=[], item_type=int, doc="missiles in the order they are met; set by the browser")
    movable = param.Boolean(default=True, doc="whether there is an order to choose")
    note = param.String(default="", doc="what the order means")
    usual = param.Boolean(default=True, doc="whether the order is that of Table 1")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


def stage_cards(target: Task, met: Sequence[int], first_guide: str) -> list[dict[str, Any]]:
    """What the component shows of each stage of the chain to `target`.

    Args:
        target: the task at the end of the chain.
        met: its missiles in the order they are met.
        first_guide: words for the guide of the first stage; every other one is guided by the stage before.
    """
    cards = []
    for number, missile in enumerate(met, start=1):
        known = sorted(met[:number])
        task = Task(target.scenario, frozenset(range(1, target.scenario.launch.missiles + 1)) - frozenset(known))
        guide = first_guide if number == 1 else f"policy of stage {number - 1}"
        colours = {str(one): missile_colour(one) for one in known}
        cards.append({"missile": missile, "title": title(task), "guide": guide, "known": known, "colours": colours})
    return cards


def single_card(task: Task, guide: str) -> list[dict[str, Any]]:
    """The one stage of a task that is trained alone."""
    colours = {str(one): missile_colour(one) for one in task.missiles}
    return [{"missile": 0, "title": title(task), "guide": guide, "known": list(task.missiles), "colours": colours}]


def read_order(text: str, missiles: int) -> tuple[list[int], str]:
    """The order in which missiles are met, from an address's list τ₁ … τ_n (met backwards), and what was wrong."""
    usual = list(range(1, missiles + 1))
    if not text:
        return usual, ""
    numbers = [int(part) for part in text.split(",") if part.isascii() and part.isdigit() and len(part) < 4]
    if sorted(numbers) != usual:
        return (
            usual,
            f"order names each of the missiles 1 to {missiles} once, the most complex first; Table 1's is taken.",
        )
    return numbers[::-1], ""


def merged(met: Sequence[int], moved: Sequence[int]) -> list[int]:
    """All missiles in order, after those of `moved` were put into that order; the others keep their places."""
    wanted = iter(moved)
    return [next(wanted) if missile in moved else missile for missile in met]
