"""The launch form of the Curriculum page: what to train, with which settings, at what cost."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui

from agents.config import VARIANTS as CONFIGURED
from agents.config import TrainingConfig
from sim.errors import SubMasError, UsageError
from sim.task import Task
from workbench.estimate import Estimate, estimate
from workbench.launcher import drain
from workbench.policies import guide_for, natural_guide, policy_choices
from workbench.runs import Run, RunStore
from workbench.scenarios import DEFAULT, other_scenario
from workbench.seeds import parse_seeds

STAGE, CHAIN = "This task", "Whole chain"
VARIANTS = {
    "SubMas-RL": "submas",
    "without policy distillation (W/o-PD)": "wo-pd",
    "without policy reuse (W/o-PR)": "wo-pr",
    "decayed distillation weight (Dec-PD)": "dec-pd",
    "decayed reuse probability (Dec-PR)": "dec-pr",
    "TD3 from scratch, no guide": "td3",
    "SAC from scratch (this task)": "sac",
    "PPO from scratch (this task)": "ppo",
}
"""Table 3's variants and the baselines, as a person reads them."""
PROFILES = {
    "fast: minutes a stage": "fast",
    "paper: Table 2, hours": "paper",
    "smoke: seconds, to try": "smoke",
}
NATURAL = "the next easier task's (default)"


class LaunchForm:
    """Widgets, the configurations they describe, and the button that launches them."""

    def __init__(self, store: RunStore, query: Mapping[str, str], launched: Callable[[list[Run]], None]) -> None:
        self._store, self._launched = store, launched
        self._task: Task | None = None
        self._scenario = DEFAULT
        self._make_widgets(query)
        self._summary = pn.pane.HTML("", sizing_mode="stretch_width", margin=0, styles={"font-size": "14px"})
        self._button = pmui.Button(
            label="Launch", icon="rocket_launch", color="primary", size="large", sizing_mode="stretch_width", margin=0
        )
        self._button.on_click(self._launch)
        for widget in self.widgets.values():
            widget.param.watch(self._change, "value")
        top = pmui.Row(self.widgets["variant"], self.widgets["profile"], margin=0, sx={"gap": "12px"})
        bottom = pmui.Row(self.widgets["seeds"], self.widgets["guide"], margin=0, sx={"gap": "12px"})
        self.layout = pmui.Column(
            self.widgets["what"], top, bottom, self.widgets["name"], self._summary, self._button,
            margin=0, sizing_mode="stretch_width", sx={"gap": "14px"},
        )  # fmt: skip

    def _make_widgets(self, query: Mapping[str, str]) -> None:
        guides = {NATURAL: "", **policy_choices(self._store)}
        common: dict[str, Any] = {"size": "small", "margin": 0, "sizing_mode": "stretch_width"}

        def choose(name: str, label: str, options: Mapping[str, str]) -> pmui.Select:
            wanted = query.get(name, "")
            value = wanted if wanted in options.values() else next(iter(options.values()))
            return pmui.Select(label=label, options=dict(options), value=value, **common)

        what = CHAIN if query.get("what", "chain") == "chain" else STAGE
        self.widgets: dict[str, Any] = {
            "what": pmui.RadioButtonGroup(options=[CHAIN, STAGE], value=what, color="primary", **common),
            "variant": choose("variant", "Variant (Table 3)", VARIANTS),
            "profile": choose("profile", "Profile", PROFILES),
            "guide": choose("guide", "Guide of the first stage", guides),
            "seeds": pmui.TextInput(label="Seeds: 0 or 0,1,2 or 0-4", value=query.get("seeds", "0")[:200], **common),
            "name": pmui.TextInput(label="Name (optional)", value="", max_length=200, **common),
        }

    def show(self, task: Task, scenario: str = DEFAULT) -> None:
        """Describe what a launch would train now that this task, of the scenario of that name or path, is chosen."""
        self._task, self._scenario = task, scenario
        self._change()

    def to_query(self) -> dict[str, str]:
        """The form as values of the address."""
        chosen = {name: self.widgets[name].value for name in ("variant", "profile", "guide", "seeds")}
        return {"what": "chain" if self.widgets["what"].value == CHAIN else "stage", **chosen}

    def configurations(self) -> list[TrainingConfig]:
        """One configuration per seed.

        Raises:
            UsageError: a value that is not legal, or a task that cannot be trained; says what would be.
        """
        assert self._task is not None
        chain = self.widgets["what"].value == CHAIN
        missiles = self._task.scenario.launch.missiles if chain else _stage_missiles(self._task)
        values = {name: self.widgets[name].value for name in ("variant", "profile", "guide", "name")}
        fixed = {"scenario": self._scenario, "curriculum": chain, "missiles": missiles, **values}
        return [TrainingConfig.from_json({**fixed, "seed": seed}) for seed in parse_seeds(self.widgets["seeds"].value)]

    def _change(self, _event: object = None) -> None:
        if self._task is None:
            return
        try:
            configs = self.configurations()
            guide_for(configs[0], self._store)
        except SubMasError as error:
            self._summary.object = f"<b>Not yet:</b> {html.escape(str(error))}."
            self._button.disabled = True
            return
        self._summary.object = summary(configs, estimate(configs[0], len(configs), self._store.list()))
        self._button.disabled = False

    def _launch(self, _event: object) -> None:
        if self._button.disabled:
            return
        # A second click that was on its way finds the button disabled.
        self._button.disabled = True
        try:
            runs = [self._store.create(config) for config in self.configurations()]
            drain(self._store)
        except SubMasError:
            self._button.disabled = False
            raise
        self._launched(runs)


def summary(configs: list[TrainingConfig], cost: Estimate) -> str:
    """What will be trained and what it costs, as HTML."""
    first = configs[0]
    runs = f"{len(configs)} runs ({cost.at_once} at once)" if len(configs) > 1 else "1 run"
    where = f" on <b>{html.escape(elsewhere)}</b>" if (elsewhere := other_scenario(first.scenario)) else ""
    stages = f"{cost.stages} stage{'s' * (cost.stages > 1)}"
    guide = html.escape(first.guide or natural_guide(first))
    guided = f"guided by <b>{guide}</b>" if CONFIGURED[first.variant].guided else "without a guide"
    early = ", less when a stage is learned early" if first.profile == "fast" else ""
    many = f"{cost.measured_runs} earlier run{'s' * (cost.measured_runs > 1)}"
    source = f"measured in {many}" if cost.measured_runs else "typical for one core"
    return (
        f"{runs}{where} of {stages} with up to {first.hyperparameters.epochs} epochs, {guided}. "
        f"At most <b>{_long(cost.at_most_s)}</b>{early} ({source})."
    )


def _long(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _stage_missiles(task: Task) -> int:
    """Number N of the task with missiles 1..N.

    Raises:
        UsageError: the task is not on the chain, or has nothing to learn.
    """
    if not task.missiles:
        raise UsageError("with every missile masked the navigation expert already solves the task; unmask missile 1")
    if task.missiles != tuple(range(1, len(task.missiles) + 1)):
        wanted = ", ".join(map(str, range(1, len(task.missiles) + 1)))
        raise UsageError(
            f"a stage is one of the chain's tasks (Table 1), and this one is not; leave missiles {wanted} instead"
        )
    return len(task.missiles)
