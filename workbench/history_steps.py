"""Which changes of an address the browser's Back button takes back."""

from __future__ import annotations

from pathlib import Path

import param
from panel.custom import JSComponent

STEPS: dict[str, tuple[str, ...]] = {
    "fly": ("a", "b", "scenario", "mask", "seed", "episode", "shot", "branch"),
    "compare": ("policies", "tasks", "scenario", "episodes", "seed"),
    "curriculum": ("scenario", "mask"),
}
"""By page: the values of its address whose change is a step of its own. Other pages walk their history themselves."""
FILLED = ("fly", "compare")
"""Pages that write what they show into an address that does not say it."""


class HistorySteps(JSComponent):
    """Nothing to see: keeps the history of one page as short as a person would.

    Panel makes every change of the address a step of its own, so that Back from a flight would pass every moment its
    clock had rested at, and the page would not follow. Here only what was chosen is a step, and Back opens the page
    as it was then.
    """

    names = param.List(default=[], item_type=str, doc="values of the address whose change is a step")
    fills = param.Boolean(default=False, doc="whether the page writes these values into an address without them")

    _esm = Path(__file__).with_suffix(".js")


def history_steps(page: str) -> list[HistorySteps]:
    """For the frame of `page`; none where the page walks its history itself."""
    if page not in STEPS:
        return []
    return [HistorySteps(names=list(STEPS[page]), fills=page in FILLED, width=0, height=0, margin=0)]
