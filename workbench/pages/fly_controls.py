"""What a person chooses on the Fly page: two policies, the missiles, the initial state."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.theme import missile_colour
from workbench.pages.fly_missiles import MissileChips
from workbench.pages.fly_settings import SEED_MAX, FlySettings

SHUFFLED = 10_000
"""Random initial states are drawn below this: a number one can say aloud."""


class FlyControls:
    """The widgets of one row; `on_change` is called when any of them changes."""

    def __init__(
        self, settings: FlySettings, labels: Mapping[str, str], missiles: int, on_change: Callable[[], None]
    ) -> None:
        common: dict[str, Any] = {
            "options": {label: spec for spec, label in labels.items()},
            "size": "small",
            "margin": 0,
            "styles": {"flex": "1 1 230px"},
        }
        self._a = pmui.Select(label="Policy A", value=settings.a, **common)
        self._b = pmui.Select(label="Policy B", value=settings.b, **common)
        colours = [missile_colour(number) for number in range(1, missiles + 1)]
        self._chips = MissileChips(
            masked=sorted(settings.masked), colours=colours, margin=0, width=52 * missiles - 2, sizing_mode="fixed"
        )
        self._seed = pmui.IntInput(
            label="Initial state", value=settings.seed, start=0, end=SEED_MAX, size="small", width=120, margin=0,
            sizing_mode="fixed",
        )  # fmt: skip
        for widget, name in ((self._a, "value"), (self._b, "value"), (self._chips, "masked"), (self._seed, "value")):
            widget.param.watch(lambda *_events: on_change(), name)
        self.items: list[pn.viewable.Viewable] = [self._a, self._b, self._chips, self._seed_row()]

    def settings(self) -> FlySettings:
        """What is chosen now, with the clock at 0."""
        return FlySettings(self._a.value, self._b.value, frozenset(self._chips.masked), self._seed.value or 0)

    def _seed_row(self) -> pn.viewable.Viewable:
        buttons = [
            self._seed_button("chevron_left", "Previous initial state", lambda seed: seed - 1),
            self._seed_button("chevron_right", "Next initial state", lambda seed: seed + 1),
            self._seed_button("casino", "A random initial state", lambda _seed: random.randrange(SHUFFLED)),
        ]
        return pmui.Row(self._seed, *buttons, margin=0, width=246, sizing_mode="fixed")

    def _seed_button(self, icon: str, words: str, choose: Callable[[int], int]) -> pmui.IconButton:
        def move(_event: object) -> None:
            self._seed.value = min(max(choose(self._seed.value or 0), 0), SEED_MAX)

        button = pmui.IconButton(icon=icon, description=words, size="medium", margin=0, sizing_mode=None)
        button.on_click(move)
        return button
