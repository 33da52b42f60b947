"""A short tour of the whole application: a button in the header, and a card that walks from page to page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent


@dataclass(frozen=True)
class Stop:
    """One card of the tour."""

    page: str
    """Address of the page it belongs to; empty for any."""
    head: str
    text: str
    """One to three sentences."""
    anchors: tuple[str, ...] = ()
    """CSS selectors of what the card points at, the best first; else it points at the page's link in the header."""


STOPS = (
    Stop(
        "", "Welcome",
        "This workbench shows how SubMas-RL learns to bring an aircraft past four missiles to an exit. The tour takes "
        "a minute; this button starts it again at any time.",
        ("[data-tour=button]",),
    ),
    Stop(
        "fly", "Two policies, one start",
        "A and B fly from the same initial state: A is what SubMas-RL has learned, B an expert's rule. The cards say "
        "how each flight ended, and the 3-D view shows it.",
        (".card.exit", ".card.failed", ".card"),
    ),
    Stop(
        "fly", "One clock",
        "Play, drag the slider, or click an event or a curve: pictures, curves and lists all show the same moment.",
        (".clock",),
    ),
    Stop(
        "curriculum", "A missile is a subtask",
        "Click a missile to mask it: its numbers leave the observation, its term leaves the reward, and an easier task "
        "is left.",
        (".tour-task",),
    ),
    Stop(
        "curriculum", "From easy to hard",
        "The curriculum meets one missile after the other; the policy of each stage guides the next. Drag a stage to "
        "change the order.",
        (".tour-chain",),
    ),
    Stop(
        "curriculum", "Train",
        "Choose variants and seeds, see what they cost on this machine, and launch. Trainings go on when the browser "
        "is closed.",
        (".tour-train",),
    ),
    Stop(
        "live", "Watch it learn",
        "Success, return and the weight of the guide, epoch by epoch; the newest policy can be flown while it trains.",
        (".tour-live",),
    ),
    Stop(
        "runs", "Everything that was trained",
        "Filter, compare and open every run. What is deleted goes to a trash first.",
        (".tour-runs", ".tabulator"),
    ),
    Stop(
        "compare", "Compare policies",
        "Success on every task with intervals, and why flights fail; each case is one click from its replay.",
        (".tour-compare",),
    ),
    Stop(
        "paper", "The paper beside our numbers",
        "Every table and figure of the paper with what this workbench measured, and the command that makes it again.",
        (".tour-paper",),
    ),
)  # fmt: skip
"""The way through the pages; stops of pages that do not exist are left out."""


class Tour(JSComponent):
    """The button in the header, and the card while the tour is on."""

    here = param.String(default="", doc="address of the page that is open")
    stops = param.List(default=[], doc="dicts of page, head, text and anchors")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


def tour(here: str, pages: Iterable[str]) -> Tour:
    """The tour's button for the header of the page `here`, one of `pages`."""
    known = {"", *pages}
    stops = [{**asdict(stop), "anchors": list(stop.anchors)} for stop in STOPS if stop.page in known]
    return Tour(
        here=here,
        stops=stops,
        margin=0,
        sizing_mode=None,
        styles={"margin-left": "auto", "width": "auto", "align-self": "center"},
    )
