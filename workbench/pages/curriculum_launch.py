"""The launch form of the Curriculum page: what to train, with which settings, at what cost."""

from __future__ import annotations

import asyncio
import html
import time
from collections.abc import Callable, Mapping, Sequence

import panel as pn
import panel_material_ui as pmui

from agents.config import VARIANTS as CONFIGURED
from agents.config import TrainingConfig
from sim.errors import SubMasError
from sim.task import Task
from workbench import speed_probe
from workbench.estimate import Estimate, estimate_set
from workbench.launcher import drain
from workbench.pages.curriculum_cost import cost_words, source_words, what_words
from workbench.pages.curriculum_fields import NATURAL, PROFILES, VARIANTS, make_fields
from workbench.pages.curriculum_set import CHAIN, STAGE, TrainingSet
from workbench.pages.wrapping import wrapping
from workbench.policies import guide_for, natural_guide
from workbench.runs import Run, RunStore
from workbench.scenarios import DEFAULT
from workbench.seeds import parse_seeds

__all__ = ["CHAIN", "NATURAL", "PROFILES", "STAGE", "VARIANTS", "LaunchForm"]

RUNS_FRESH_S = 5.0
"""How long a look at the runs folder is good for while somebody types."""


class LaunchForm:
    """Widgets, the configurations they describe, and the button that launches them."""

    def __init__(self, store: RunStore, query: Mapping[str, str], launched: Callable[[list[Run]], None]) -> None:
        self._store, self._launched = store, launched
        self._task: Task | None = None
        self._scenario, self._met = DEFAULT, ()
        self._runs: tuple[float, list[Run]] = (-RUNS_FRESH_S, [])
        self.first_guide = ""
        """POLICY that guides the first stage, as far as it is known; empty when nothing can."""
        self.widgets = make_fields(query, store)
        self._summary = pn.pane.HTML("", sizing_mode="stretch_width", margin=0, styles={"font-size": "14px"})
        self._button = pmui.Button(
            label="Launch", icon="rocket_launch", color="primary", size="large", margin=0, width=240,
            sizing_mode="fixed",
        )  # fmt: skip
        self._measure = pmui.Button(
            label="Measure here", icon="speed", variant="outlined", size="small", margin=0, sizing_mode=None,
            description="Time a part of an epoch in a process of its own: about 15 seconds", visible=False,
        )  # fmt: skip
        self._button.on_click(self._launch)
        self._measure.on_click(self._probe)
        for widget in self.widgets.values():
            widget.param.watch(self._change, "value")
        self.layout = self._arrange()

    def _arrange(self) -> pmui.Column:
        fields = ("what", "profile", "seeds", "guide", "name")
        row = wrapping(*(self.widgets[name] for name in fields), gap="14px", align="center")
        say = pmui.Column(self._summary, self._measure, margin=0, sizing_mode="stretch_width", sx={"gap": "6px"})
        last = pmui.Row(
            say, self._button, margin=0, sizing_mode="stretch_width", sx={"gap": "18px", "alignItems": "center"}
        )
        return pmui.Column(
            row, self.widgets["variant"], last, margin=0, sizing_mode="stretch_width", sx={"gap": "14px"}
        )

    def show(self, task: Task, scenario: str = DEFAULT, met: Sequence[int] = ()) -> None:
        """Describe what a launch would train now.

        Args:
            task: the task that is chosen.
            scenario: its scenario, by name or path.
            met: its missiles in the order a chain meets them; ascending when left out.
        """
        self._task, self._scenario, self._met = task, scenario, tuple(met or task.missiles)
        self._change()

    def to_query(self) -> dict[str, str]:
        """The form as values of the address."""
        chosen = {name: self.widgets[name].value for name in ("profile", "guide", "seeds")}
        what = "chain" if self.chain else "stage"
        return {"what": what, "variant": ",".join(self.widgets["variant"].value), **chosen}

    @property
    def chain(self) -> bool:
        """Whether the whole chain up to the task is trained."""
        return self.widgets["what"].value == CHAIN and not self.from_scratch

    @property
    def from_scratch(self) -> bool:
        """Whether all that is chosen learns without a guide, and so the task itself."""
        variants = self.widgets["variant"].value
        return bool(variants) and not any(CONFIGURED[variant].guided for variant in variants)

    def configurations(self) -> list[TrainingConfig]:
        """One configuration per variant and seed.

        Raises:
            UsageError: a value that is not legal, or a task that cannot be trained; says what would be.
        """
        assert self._task is not None
        values = {name: self.widgets[name].value for name in ("profile", "guide", "name")}
        seeds, variants = tuple(parse_seeds(self.widgets["seeds"].value)), tuple(self.widgets["variant"].value)
        chosen = TrainingSet(self._task, self._scenario, self.chain, self._met, variants, seeds, **values)
        return chosen.configurations()

    def _change(self, _event: object = None) -> None:
        if self._task is None:
            return
        self._button.label, self._measure.visible = "Launch", False
        self.first_guide = ""
        try:
            configs = self.configurations()
            # Who learns from scratch names a guide as well, and never asks it.
            asking = [config for config in configs if CONFIGURED[config.variant].guided]
            guides = {config.guide or natural_guide(config): config for config in asking}
            for config in guides.values():
                guide_for(config, self._store)
        except SubMasError as error:
            self._summary.object = f"<b>Not yet:</b> {html.escape(str(error))}."
            self._button.disabled = True
            return
        self.first_guide = next(iter(guides), "")
        self._describe(configs)
        self._button.label = f"Launch {len(configs)} runs" if len(configs) > 1 else "Launch and watch"
        self._button.disabled = False

    def _describe(self, configs: list[TrainingConfig]) -> None:
        cost = estimate_set(configs, self._recent_runs(), speed_probe.remembered())
        self._summary.object = summary(configs, cost, self.first_guide)
        self._measure.visible = any(
            kind[1] == "td3" and speed.source != "runs" for kind, speed in (cost.speeds or {}).items()
        )

    def _recent_runs(self) -> list[Run]:
        if time.monotonic() - self._runs[0] > RUNS_FRESH_S:
            self._runs = (time.monotonic(), self._store.list())
        return self._runs[1]

    async def _probe(self, _event: object) -> None:
        profile = self.widgets["profile"].value
        self._measure.disabled, self._measure.label = True, "Measuring: about 15 seconds …"
        try:
            await speed_probe.probe(profile)
        finally:
            self._measure.disabled, self._measure.label = False, "Measure here"
        self._change()

    async def _launch(self, _event: object) -> None:
        if self._button.disabled:
            return
        # A second click that was on its way finds the button disabled.
        self._button.disabled = True
        try:
            runs = await asyncio.to_thread(self._start, self.configurations())
        except SubMasError:
            self._button.disabled = False
            raise
        self._runs = (-RUNS_FRESH_S, [])
        self._launched(runs)

    def _start(self, configs: list[TrainingConfig]) -> list[Run]:
        runs = [self._store.create(config) for config in configs]
        drain(self._store)
        return runs


def summary(configs: list[TrainingConfig], cost: Estimate, first_guide: str) -> str:
    """What will be trained and what it costs, as HTML."""
    small = f'<span style="opacity:.75;font-size:12.5px">{source_words(cost)}</span>'
    return f"{what_words(configs, first_guide)}<br>{cost_words(cost, len(configs))} {small}"
