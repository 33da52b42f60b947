"""What is seen and pressed of "Take the stick": whose flight, who flies on, the dial, the card of the branch."""

from __future__ import annotations

from collections.abc import Mapping

import panel as pn
import panel_material_ui as pmui

from workbench.pages.fly_stick_card import BRANCH_CARD_CSS
from workbench.pages.fly_stick_dial import HeadingDial
from workbench.pages.fly_stick_moment import StickMoment
from workbench.pages.wrapping import wrapping

HOLD = ""
"""Who flies on after a person when nobody does: the last heading is held."""
BOX = {
    "gap": "10px", "padding": "8px 12px", "border-radius": "8px",
    "border": "1px solid color-mix(in srgb, var(--panel-on-background-color) 20%, transparent)",
}  # fmt: skip
CHARTS_CSS = """
:host { display: grid !important; grid-template-columns: repeat(auto-fit, minmax(400px, 1fr)); gap: 12px;
  height: auto !important }
"""
TITLE = "<b style='font-size: 15px'>Take the stick</b> &ensp;of flight"
# A tooltip becomes the name of its button, so each begins with the words on the button.
HELP = "Fly on: from this moment this policy flies; see the branch beside the original"
STEER_HELP = "I fly: from this moment steer by arrow keys or mouse; hand over to a policy when you like"


class StickWidgets:
    """The parts and their order; what they do is for `workbench.pages.fly_stick` to connect."""

    def __init__(self, labels: Mapping[str, str]) -> None:
        policies = {label: spec for spec, label in labels.items()}
        self.of = pmui.RadioButtonGroup(options=["A", "B"], value="A", size="small", margin=0, sizing_mode=None)
        self.who = _select("Who flies on", policies, "1 1 220px")
        self.first = self.who.value
        """Who flies on until somebody has chosen."""
        self.take = _button("Fly on", "call_split", "contained", HELP)
        self.steer = _button("I fly", "sports_esports", "outlined", STEER_HELP)
        self.moment = StickMoment(margin=0, sizing_mode=None)
        self.problem = pmui.Alert(object="", severity="warning", visible=False, margin=0, sizing_mode="stretch_width")
        self.dial = HeadingDial(margin=0, sizing_mode="stretch_width")
        self.heir = _select("Then flies", {"Nobody: hold the heading": HOLD} | policies, "0 1 260px")
        self.hand_over = _button(
            "Hand over", "pan_tool", "contained", "Hand over: end steering; the branch is flown to its end"
        )
        self.cancel = _button("Cancel", "close", "text", "Cancel: forget what was flown by hand")
        self.card = pn.pane.HTML("", stylesheets=[BRANCH_CARD_CSS], margin=0, styles={"flex": "1 1 560px"})
        self.steer_on = _button("Steer on", "sports_esports", "outlined", STEER_ON_HELP)
        self.back = _button("Back to the original", "undo", "outlined", "Back to the original: remove the branch")
        self.charts = pn.Row(sizing_mode="stretch_width", margin=0, stylesheets=[CHARTS_CSS])
        # A grid of its own display cannot be hidden; what is around it can.
        self._below = pn.Column(self.charts, sizing_mode="stretch_width", margin=0)
        self._choice, self._live, self._branch = self._rows()
        self.layout = pn.Column(
            self.problem, self._choice, self._live, self._branch, self._below,
            sizing_mode="stretch_width", margin=0, styles={"gap": "8px"}, css_classes=["take-the-stick"],
        )  # fmt: skip
        self.show(live=False, branch=False)

    def show(self, *, live: bool, branch: bool) -> None:
        """Show what belongs to choosing, to flying by hand, or to a branch that has been flown."""
        self._choice.visible = not live
        self._live.visible = live
        self._branch.visible = self._below.visible = branch and not live

    def tell(self, over: bool) -> None:
        """Say whether there is a flight left to take over."""
        if over != self.moment.over:
            self.moment.over = self.take.disabled = self.steer.disabled = over

    def _rows(self) -> tuple[pn.viewable.Viewable, ...]:
        look = {"gap": "12px", "align": "center"}
        title = pn.pane.HTML(TITLE, margin=0, sizing_mode=None, styles={"font-size": "14px", "white-space": "nowrap"})
        choice = wrapping(title, self.of, self.moment, self.who, self.take, self.steer, styles=BOX, **look)
        ends = wrapping(self.heir, self.hand_over, self.cancel, **look)
        live = pn.Column(self.dial, ends, sizing_mode="stretch_width", margin=0, styles=BOX)
        buttons = pn.Row(self.steer_on, self.back, margin=0, sizing_mode=None, styles={"gap": "8px"})
        return choice, live, wrapping(self.card, buttons, **look)


STEER_ON_HELP = "Steer on: take the stick again where the clock is, or at last where you handed over"


def _select(label: str, options: dict[str, str], flex: str) -> pmui.Select:
    return pmui.Select(
        label=label, options=options, value=next(iter(options.values())), size="small", margin=0, styles={"flex": flex}
    )


def _button(label: str, icon: str, variant: str, words: str) -> pmui.Button:
    return pmui.Button(label=label, icon=icon, variant=variant, description=words, margin=0, sizing_mode=None)
