"""What a person chooses on the Fly page: two policies, the scenario, its missiles, the initial state."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.theme import missile_colour
from sim.scenario_file import load_scenario
from workbench.pages.fly_missiles import MissileChips
from workbench.pages.fly_settings import SEED_MAX, FlySettings
from workbench.pages.number_field import NumberField

SHUFFLED = 10_000
"""Random initial states are drawn below this: a number one can say aloud."""
CHIP_WIDTH = 52


class FlyControls:
    """The widgets of one row; `on_change` is called when any of them changes."""

    def __init__(
        self,
        settings: FlySettings,
        labels: Mapping[str, str],
        scenarios: Mapping[str, str],
        on_change: Callable[[], None],
    ) -> None:
        options = {label: spec for spec, label in labels.items()}
        self._a = _select("Policy A", options, settings.a, "1 1 210px")
        self._b = _select("Policy B", options, settings.b, "1 1 210px")
        self._scenario = _select("Scenario", dict(scenarios), settings.scenario, "0 1 190px")
        self._chips = MissileChips(margin=0, sizing_mode="fixed", **_missiles(settings.scenario, settings.masked))
        self._seed = NumberField(
            label="Initial state", value=settings.seed, start=0, end=SEED_MAX, width=120, margin=0, sizing_mode="fixed"
        )
        # First: the missiles of the new scenario are there when its flights are asked for.
        self._scenario.param.watch(self._change_scenario, "value")
        watched = [(self._chips, "masked")] + [(w, "value") for w in (self._a, self._b, self._scenario, self._seed)]
        for widget, name in watched:
            widget.param.watch(lambda *_events: on_change(), name)
        self.items: list[pn.viewable.Viewable] = [self._a, self._b, self._scenario, self._chips, self._seed_row()]

    def settings(self) -> FlySettings:
        """What is chosen now, with the clock at 0."""
        masked, seed = frozenset(self._chips.masked), self._seed.value
        return FlySettings(self._a.value, self._b.value, masked, seed, scenario=self._scenario.value)

    def mask(self, missiles: Iterable[int]) -> None:
        """Mask exactly these missiles, as if a person had clicked them."""
        self._chips.masked = sorted(missiles)

    def _change_scenario(self, event: Any) -> None:
        self._chips.param.update(**_missiles(event.new, self._chips.masked))

    def _seed_row(self) -> pn.viewable.Viewable:
        buttons = [
            self._seed_button("chevron_left", "Previous initial state", lambda seed: seed - 1),
            self._seed_button("chevron_right", "Next initial state", lambda seed: seed + 1),
            self._seed_button("casino", "A random initial state", lambda _seed: random.randrange(SHUFFLED)),
        ]
        return pmui.Row(self._seed, *buttons, margin=0, width=246, sizing_mode="fixed")

    def _seed_button(self, icon: str, words: str, choose: Callable[[int], int]) -> pmui.IconButton:
        def move(_event: object) -> None:
            self._seed.value = min(max(choose(self._seed.value), 0), SEED_MAX)

        button = pmui.IconButton(icon=icon, description=words, size="medium", margin=0, sizing_mode=None)
        button.on_click(move)
        return button


def _select(label: str, options: dict[str, str], value: str, flex: str) -> pmui.Select:
    return pmui.Select(label=label, options=options, value=value, size="small", margin=0, styles={"flex": flex})


def _missiles(scenario: str, masked: Iterable[int]) -> dict[str, Any]:
    """The chips of a scenario: as many as it has missiles; masks of others are forgotten."""
    missiles = load_scenario(scenario).launch.missiles
    colours = [missile_colour(number) for number in range(1, missiles + 1)]
    kept = sorted(number for number in masked if number <= missiles)
    return {"colours": colours, "masked": kept, "width": max(CHIP_WIDTH * missiles - 2, 150)}
